#include "palpable/bake/mesh/inp_file.h"

#include "palpable/bake/mesh/inp_include.h"
#include "palpable/bake/mesh/inp_keyword.h"
#include "palpable/bake/mesh/inp_motion.h"
#include "palpable/bake/mesh/mesh_text.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/base/text_numbers.h"
#include "palpable/common/base/whole_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace palpable {
namespace {

using inp::Keyword;
using inp::split;
using inp::trimmed;
using inp::upper;

// The line with a blank for each comma before a blank: "1, 0,5, 2,5" as "1  0,5  2,5".
std::string without_separators(std::string_view line) {
  std::string text(line);
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool ends_word = i + 1 == text.size() || text[i + 1] == ' ' || text[i + 1] == '\t';
    if (text[i] == ',' && ends_word) text[i] = ' ';
  }
  return text;
}

enum class Kind { kTet4, kTet10, kTriangle3, kTriangle6, kSkipped, kOtherSolid };

bool is_one_of(std::string_view word, std::initializer_list<std::string_view> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

// C3D4H, C3D10M and the like have the nodes of C3D4 and C3D10.
bool is_variant(std::string_view type, std::string_view of) {
  if (!type.starts_with(of)) return false;
  return std::all_of(type.begin() + static_cast<std::ptrdiff_t>(of.size()), type.end(),
                     [](char c) { return c >= 'A' && c <= 'Z'; });
}

Kind kind_of(const std::string& type) {
  if (is_variant(type, "C3D10")) return Kind::kTet10;
  if (is_variant(type, "C3D4")) return Kind::kTet4;
  if (is_one_of(type, {"S3", "S3R", "STRI3", "DS3", "M3D3", "CPS3", "CPE3", "CAX3", "SFM3D3"})) {
    return Kind::kTriangle3;
  }
  if (is_one_of(type, {"S6", "STRI65", "DS6", "M3D6", "CPS6", "CPE6", "CAX6", "SFM3D6"})) {
    return Kind::kTriangle6;
  }
  for (const char* solid : {"C3D", "DC3D", "AC3D", "F3D", "CC3D", "SC6", "SC8"}) {
    if (type.starts_with(solid)) return Kind::kOtherSolid;
  }
  return Kind::kSkipped;
}

int nodes_of(Kind kind) {
  switch (kind) {
    case Kind::kTet4:
      return 4;
    case Kind::kTet10:
      return 10;
    case Kind::kTriangle3:
      return 3;
    case Kind::kTriangle6:
      return 6;
    default:
      return 0;
  }
}

// What to do about parts and instances.
constexpr std::string_view kSaveFlat =
    "save the deck flat (in Abaqus: Model, Edit Attributes, \"Do not use parts and assemblies in "
    "input files\")";

// Faces S1 to S4 by corners.
constexpr std::array<std::array<std::size_t, 3>, 4> kFaces{
    {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}}};

class InpReader {
 public:
  // @param deck  outlives the reader; @param name  of its file
  InpReader(const inp::Deck& deck, std::string_view name)
      : deck_(deck), name_(name), text_(deck.text) {}

  FileMesh read() {
    next();
    while (line_) {
      if (!line_->starts_with('*')) {
        if (!seen_keyword_) {
          text_.bad("not an Abaqus or CalculiX deck: it does not begin with a keyword (*NODE)");
        }
        next();  // data of a keyword that is skipped
        continue;
      }
      seen_keyword_ = true;
      const Keyword keyword = read_keyword();
      read_data(keyword);
    }
    resolve_surfaces();
    return std::move(mesh_);
  }

 private:
  // The next line that is neither empty nor a comment, into line_.
  void next() {
    do {
      line_ = text_.next_line();
      if (line_) line_ = trimmed(*line_);
    } while (line_ && (line_->empty() || line_->starts_with("**")));
  }

  Keyword read_keyword() {
    const std::size_t line = text_.line();
    std::string all(*line_);
    next();
    while (all.ends_with(',') && line_ && !line_->starts_with('*')) {
      all += *line_;
      next();
    }
    return inp::parse_keyword(all, line);
  }

  void read_data(const Keyword& keyword) {
    const std::string& name = keyword.name;
    if (name == "*NODE") return read_nodes(keyword);
    if (name == "*ELEMENT") return read_elements(keyword);
    if (name == "*NSET") return read_node_set(keyword);
    if (name == "*ELSET") return read_element_set(keyword);
    if (name == "*SURFACE") return read_surface(keyword);
    if (name == "*PART") return count_part(keyword, part_);
    if (name == "*INSTANCE") return read_instance(keyword);
    if (name == "*END INSTANCE") return move_nodes();
    if (name == "*INCLUDE") throw MeshDefect{keyword.line, "*INCLUDE names no file (INPUT=)"};
    if (is_one_of(name, {"*SYSTEM", "*NCOPY", "*NGEN", "*NFILL", "*ELGEN", "*ELCOPY"})) {
      throw MeshDefect{keyword.line,
                       fmt::format("{} is not read; save the deck with a list of all nodes and "
                                   "elements",
                                   name)};
    }
    // Other keywords do not concern the mesh; read() skips their data lines.
  }

  void read_instance(const Keyword& keyword) {
    count_part(keyword, instance_);
    std::vector<std::string_view> lines;
    for (; line_ && !line_->starts_with('*'); next()) lines.push_back(*line_);
    motion_ = inp::instance_motion(lines);
    if (motion_) return;
    throw MeshDefect{
        keyword.line,
        fmt::format("the lines of the *INSTANCE '{}' are not a translation (3 numbers) "
                    "and perhaps a rotation (two points and an angle)",
                    instance_)};
  }

  // Puts the part, and the nodes of the instance itself, where the instance is.
  void move_nodes() {
    if (!motion_ || motion_->matrix().isIdentity(0.0)) return;
    for (auto& [number, x] : mesh_.nodes) x = *motion_ * x;
    motion_.reset();
  }

  // Keeps the name of the only *PART or *INSTANCE.
  void count_part(const Keyword& keyword, std::string& only) const {
    std::string name = keyword.get("NAME").substr(0, 40);
    if (name.empty()) name = "without a name";
    if (!only.empty()) {
      throw MeshDefect{keyword.line,
                       fmt::format("a second {}, '{}', beside '{}'; one body is read: delete the "
                                   "others, or {}",
                                   keyword.name, name, only, kSaveFlat)};
    }
    only = name;
  }

  template <class T>
  std::optional<T> number_in(std::string_view word) const {
    T value{};
    if (word.starts_with('+')) word.remove_prefix(1);
    const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (code != std::errc() || end != word.data() + word.size()) return std::nullopt;
    return value;
  }

  std::int64_t need_number(std::string_view word, const char* what) const {
    const auto value = number_in<std::int64_t>(word);
    if (!value) text_.bad(fmt::format("{} is '{}', not a whole number", what, word.substr(0, 40)));
    return *value;
  }

  void read_nodes(const Keyword& keyword) {
    if (is_one_of(upper(keyword.get("SYSTEM")), {"C", "S"})) {
      text_.bad(
          "nodes in cylindrical or spherical coordinates; save the deck with rectangular ones");
    }
    std::vector<std::int64_t>* set = nullptr;
    if (keyword.has("NSET")) set = &node_set(keyword.get("NSET"), keyword).numbers;
    for (; line_ && !line_->starts_with('*'); next()) {
      const std::vector<std::string_view> words = split(*line_);
      const std::int64_t number = need_number(words[0], "a node's number");
      Eigen::Vector3d x = Eigen::Vector3d::Zero();
      if (words.size() < 4) text_.bad(fmt::format("node {} has no three coordinates", number));
      if (words.size() > 4 && has_decimal_commas(without_separators(*line_))) {
        text_.bad(fmt::format("node {} {}", number, kDecimalCommas));
      }
      for (std::size_t k = 0; k < 3; ++k) {
        // Fortran's exponent is a D.
        std::string word(words[k + 1]);
        std::replace(word.begin(), word.end(), 'D', 'E');
        std::replace(word.begin(), word.end(), 'd', 'e');
        const auto value = number_in<double>(word);
        if (!value) {
          text_.bad(fmt::format("a coordinate is '{}', not a number", words[k + 1].substr(0, 40)));
        }
        x[static_cast<Eigen::Index>(k)] = *value;
      }
      if (!x.allFinite()) text_.bad(fmt::format("node {} is not a finite point", number));
      if (!mesh_.nodes.emplace(number, x).second) {
        text_.bad(fmt::format("node {} comes twice", number));
      }
      if (set != nullptr) set->push_back(number);
    }
  }

  // The numbers of one element, which may continue on further lines.
  std::vector<std::int64_t> element_row(std::size_t count) {
    std::vector<std::int64_t> row;
    const std::size_t first_line = text_.line();
    while (row.size() < count) {
      if (!line_ || line_->starts_with('*')) {
        throw MeshDefect{
            first_line,
            fmt::format("element {} has {} nodes of {}; the file may have been cut off",
                        row.empty() ? 0 : row[0], row.empty() ? 0 : row.size() - 1, count - 1)};
      }
      for (const std::string_view word : split(*line_)) {
        row.push_back(need_number(word, row.empty() ? "an element's number" : "a node number"));
      }
      next();
    }
    if (row.size() > count) {
      throw MeshDefect{first_line, fmt::format("element {} has {} nodes instead of {}", row[0],
                                               row.size() - 1, count - 1)};
    }
    return row;
  }

  void read_elements(const Keyword& keyword) {
    const std::string type = upper(keyword.get("TYPE"));
    if (type.empty()) throw MeshDefect{keyword.line, "*ELEMENT without TYPE="};
    const Kind kind = kind_of(type);
    if (kind == Kind::kOtherSolid) {
      throw MeshDefect{keyword.line,
                       fmt::format("element type {} is not supported; only tetrahedra, C3D4 and "
                                   "C3D10, are read: mesh the body with those",
                                   type.substr(0, 40))};
    }
    if (kind == Kind::kSkipped) {
      skipped_elements_ = true;
      return;
    }
    const auto node_count = static_cast<std::size_t>(nodes_of(kind));
    const bool is_tet = kind == Kind::kTet4 || kind == Kind::kTet10;
    const std::string set = keyword.get("ELSET");
    while (line_ && !line_->starts_with('*')) {
      const std::size_t at = text_.line();
      const std::vector<std::int64_t> row = element_row(node_count + 1);
      if (!element_of_.emplace(row[0], is_tet ? static_cast<int>(mesh_.tets.size()) : -1).second) {
        throw MeshDefect{at, fmt::format("element {} comes twice", row[0])};
      }
      if (is_tet) {
        FileMesh::Tet tet{row[0], at, nodes_of(kind), {}};
        std::copy(row.begin() + 1, row.end(), tet.nodes.begin());
        mesh_.tets.push_back(tet);
      } else {
        triangles_[row[0]] = {row[1], row[2], row[3]};
      }
      if (!set.empty()) add_element(canonical(set, element_names_), row[0]);
    }
  }

  // A set's name as it was first written: names that differ in case are the same.
  static const std::string& canonical(const std::string& name,
                                      std::map<std::string, std::string>& names) {
    return names.try_emplace(upper(name), name).first->second;
  }

  FileMesh::Nodes& node_set(const std::string& name, const Keyword& keyword) {
    FileMesh::Nodes& set = mesh_.node_sets[canonical(name, node_names_)];
    if (set.line == 0) set.line = keyword.line;
    return set;
  }

  void add_element(const std::string& set, std::int64_t number) {
    elements_[set].push_back(number);
    const int tet = element_of_.at(number);
    if (tet >= 0) {
      mesh_.tet_sets[set].push_back(tet);
    } else {
      mesh_.face_sets[set].push_back(triangles_.at(number));
    }
  }

  std::string need_name(const Keyword& keyword, const char* key) const {
    std::string name = keyword.get(key);
    if (name.empty()) throw MeshDefect{keyword.line, keyword.name + " without a name"};
    return name;
  }

  // The numbers of a GENERATE line (first, last, step). Some may be missing where elements were
  // skipped.
  template <class Known>
  std::vector<std::int64_t> generated(const std::vector<std::string_view>& words,
                                      const Known& known, const char* what,
                                      bool may_miss = false) const {
    if (words.size() < 2) text_.bad("GENERATE needs a first and a last number");
    const std::int64_t first = need_number(words[0], "the first number");
    const std::int64_t last = need_number(words[1], "the last number");
    const std::int64_t step = words.size() > 2 ? need_number(words[2], "the step") : 1;
    if (step < 1 || first < 0 || last < first) {
      text_.bad(
          "GENERATE needs a first number, a last one that is not smaller, and a step above 0");
    }
    std::vector<std::int64_t> numbers;
    if (may_miss) {
      for (const auto& [n, content] : known) {
        if (n >= first && n <= last && (n - first) % step == 0) numbers.push_back(n);
      }
      std::sort(numbers.begin(), numbers.end());
      return numbers;
    }
    if (static_cast<std::uint64_t>((last - first) / step) >= known.size()) {
      text_.bad(fmt::format("GENERATE names more {}s than there are", what));
    }
    for (std::int64_t n = first; n <= last; n += step) {
      if (!known.contains(n)) text_.bad(fmt::format("{} {} does not exist", what, n));
      numbers.push_back(n);
      if (n > last - step) break;  // n + step might be out of range
    }
    return numbers;
  }

  void read_node_set(const Keyword& keyword) {
    FileMesh::Nodes& set = node_set(need_name(keyword, "NSET"), keyword);
    if (keyword.has("ELSET")) add_nodes_of(keyword, set);
    for (; line_ && !line_->starts_with('*'); next()) {
      const std::vector<std::string_view> words = split(*line_);
      if (keyword.has("GENERATE")) {
        for (const std::int64_t n : generated(words, mesh_.nodes, "node")) set.numbers.push_back(n);
        continue;
      }
      for (const std::string_view word : words) {
        if (const auto number = number_in<std::int64_t>(word)) {
          set.numbers.push_back(*number);
          continue;
        }
        const auto other = node_names_.find(upper(word));
        if (other == node_names_.end()) {
          text_.bad(fmt::format("'{}' is neither a node nor a set of nodes named before",
                                word.substr(0, 40)));
        }
        const std::vector<std::int64_t> more = mesh_.node_sets[other->second].numbers;
        set.numbers.insert(set.numbers.end(), more.begin(), more.end());
        bound(set.numbers.size());
      }
    }
  }

  // *NSET, NSET=.., ELSET=..: the nodes of a set of elements.
  void add_nodes_of(const Keyword& keyword, FileMesh::Nodes& set) {
    const std::string wanted = keyword.get("ELSET");
    const auto elements = element_names_.find(upper(wanted));
    if (elements == element_names_.end()) {
      throw MeshDefect{keyword.line, fmt::format("'{}' is no set of elements named before",
                                                 wanted.substr(0, 40))};
    }
    for (const std::int64_t number : elements_[elements->second]) {
      const int tet = element_of_.at(number);
      if (tet < 0) {
        const auto& corners = triangles_.at(number);
        set.numbers.insert(set.numbers.end(), corners.begin(), corners.end());
        continue;
      }
      const FileMesh::Tet& element = mesh_.tets[tet];
      set.numbers.insert(set.numbers.end(), element.nodes.begin(),
                         element.nodes.begin() + element.node_count);
    }
    bound(set.numbers.size());
  }

  // Limits the size of a set: one that names itself would double with each line.
  void bound(std::size_t size) const {
    constexpr std::size_t kMost = 10'000'000;
    if (size > kMost) text_.bad("a set has more than 10 million entries");
  }

  void read_element_set(const Keyword& keyword) {
    const std::string name = canonical(need_name(keyword, "ELSET"), element_names_);
    elements_.try_emplace(name);
    for (; line_ && !line_->starts_with('*'); next()) {
      const std::vector<std::string_view> words = split(*line_);
      if (keyword.has("GENERATE")) {
        for (const std::int64_t n : generated(words, element_of_, "element", skipped_elements_)) {
          add_element(name, n);
        }
        continue;
      }
      for (const std::string_view word : words) {
        if (const auto number = number_in<std::int64_t>(word)) {
          if (element_of_.contains(*number)) {
            add_element(name, *number);
          } else if (!skipped_elements_) {
            text_.bad(fmt::format("element {} does not exist", *number));
          }
          continue;
        }
        const auto other = element_names_.find(upper(word));
        if (other == element_names_.end()) {
          text_.bad(fmt::format("'{}' is neither an element nor a set of elements named before",
                                word.substr(0, 40)));
        }
        const std::vector<std::int64_t> more = elements_[other->second];
        for (const std::int64_t n : more) add_element(name, n);
        bound(elements_[name].size());
      }
    }
  }

  void read_surface(const Keyword& keyword) {
    const std::string type = upper(keyword.get("TYPE"));
    if (!type.empty() && type != "ELEMENT") return;  // of nodes, or made of other surfaces
    const std::string name = canonical(need_name(keyword, "NAME"), surface_names_);
    mesh_.face_sets.try_emplace(name);
    for (; line_ && !line_->starts_with('*'); next()) {
      const std::vector<std::string_view> words = split(*line_);
      const std::string face = words.size() > 1 ? upper(words[1]) : "";
      if (face.size() != 2 || face[0] != 'S' || face[1] < '1' || face[1] > '4') {
        leave_out(name, text_.line(),
                  fmt::format("'{}' is no face of a tetrahedron; those are S1 to S4",
                              face.substr(0, 40)));
        continue;
      }
      surfaces_.push_back(
          {name, std::string(words[0]), static_cast<std::size_t>(face[1] - '1'), text_.line()});
    }
  }

  // Records that a surface cannot be used. A deck may hold surfaces that the body does not need: of
  // shells, springs, rigid bodies.
  void leave_out(const std::string& surface, std::size_t line, const std::string& why) {
    mesh_.unusable.try_emplace(surface, fmt::format("{}: {}", deck_.place(line, name_), why));
  }

  // Called at the end, since a surface may come before its sets.
  void resolve_surfaces() {
    for (const SurfaceRow& row : surfaces_) {
      std::vector<std::int64_t> elements;
      if (const auto number = number_in<std::int64_t>(row.elements)) {
        elements.push_back(*number);
      } else {
        const auto set = element_names_.find(upper(row.elements));
        if (set == element_names_.end()) {
          leave_out(row.name, row.line,
                    fmt::format("'{}' is neither an element nor a set of elements",
                                row.elements.substr(0, 40)));
          continue;
        }
        elements = elements_[set->second];
      }
      for (const std::int64_t number : elements) {
        const auto at = element_of_.find(number);
        if (at == element_of_.end() || at->second < 0) {
          leave_out(row.name, row.line, fmt::format("element {} is no tetrahedron", number));
          break;
        }
        const auto& nodes = mesh_.tets[at->second].nodes;
        const auto& face = kFaces[row.face];
        mesh_.face_sets[row.name].push_back({nodes[face[0]], nodes[face[1]], nodes[face[2]]});
      }
    }
    for (const auto& [name, why] : mesh_.unusable) mesh_.face_sets.erase(name);
  }

  struct SurfaceRow {
    std::string name, elements;
    std::size_t face, line;
  };

  const inp::Deck& deck_;
  std::string_view name_;
  MeshText text_;
  std::optional<std::string_view> line_;  // the current line
  bool seen_keyword_ = false, skipped_elements_ = false;
  std::string part_, instance_;
  std::optional<Eigen::Isometry3d> motion_;  // of the instance that is being read
  FileMesh mesh_;
  std::unordered_map<std::int64_t, int> element_of_;  // number -> tetrahedron, -1: a triangle
  std::unordered_map<std::int64_t, std::array<std::int64_t, 3>> triangles_;  // corners by number
  std::map<std::string, std::vector<std::int64_t>> elements_;                // of each set
  std::map<std::string, std::string> node_names_, element_names_, surface_names_;  // upper -> first
  std::vector<SurfaceRow> surfaces_;
};

}  // namespace

namespace {

Result<VolumeMesh> parse_deck(const inp::Deck& deck, std::string_view name) {
  return read_mesh_text(
      deck.text, name, [&](std::string_view /*text*/) { return InpReader(deck, name).read(); },
      [&](std::size_t line) { return deck.place(line, name); });
}

}  // namespace

Result<VolumeMesh> parse_inp(std::string_view text, std::string_view name) {
  return parse_deck({std::string(text)}, name);
}

Result<VolumeMesh> read_inp_file(const std::filesystem::path& path) {
  const auto read = [](const std::filesystem::path& file, std::uintmax_t most) {
    return read_text_file(file, {.most = most});
  };
  Result<std::string> text = read(path, kLargestMeshText);
  if (!text) return Problem{fmt::format("{}: {}", path.string(), text.problem().message)};
  const std::uintmax_t left = kLargestMeshText - text.value().size();
  const Result<inp::Deck> deck = inp::with_includes(std::move(text).value(), path, left, read);
  if (!deck) return Problem{deck.problem()};
  return parse_deck(deck.value(), path.string());
}

void write_inp_file(const std::filesystem::path& path, const TetMesh& mesh) {
  std::string text = "** palpable mesh\n*NODE\n";
  for (int n = 0; n < mesh.node_count(); ++n) {
    const auto x = mesh.nodes.col(n);  // fmt's default is the shortest text that reads back exactly
    text += fmt::format("{}, {}, {}, {}\n", n + 1, x[0], x[1], x[2]);
  }
  text += fmt::format("*ELEMENT, TYPE={}, ELSET=BODY\n", mesh.is_quadratic() ? "C3D10" : "C3D4");
  // Each face by its sorted corners: those of the skin are of one tetrahedron only.
  std::map<std::array<int, 3>, std::vector<std::pair<int, std::size_t>>> faces;
  for (int e = 0; e < mesh.tet_count(); ++e) {
    text += fmt::format("{}", e + 1);
    for (int k = 0; k < 4; ++k) text += fmt::format(", {}", mesh.tets(k, e) + 1);
    for (int k = 0; mesh.is_quadratic() && k < 6; ++k) {
      text += fmt::format(", {}", mesh.edge_nodes(k, e) + 1);
    }
    text += '\n';
    for (std::size_t f = 0; f < kFaces.size(); ++f) {
      std::array<int, 3> corners{};
      for (std::size_t k = 0; k < 3; ++k) {
        corners[k] = mesh.tets(static_cast<Eigen::Index>(kFaces[f][k]), e);
      }
      std::sort(corners.begin(), corners.end());
      faces[corners].emplace_back(e, f);
    }
  }
  text += "*SURFACE, NAME=BOUNDARY, TYPE=ELEMENT\n";
  for (const auto& [corners, of] : faces) {
    if (of.size() == 1) text += fmt::format("{}, S{}\n", of[0].first + 1, of[0].second + 1);
  }
  write_whole_file(path, text);
}

}  // namespace palpable

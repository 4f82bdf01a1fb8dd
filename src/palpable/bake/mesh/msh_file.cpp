#include "palpable/bake/mesh/msh_file.h"

#include "palpable/bake/mesh/mesh_text.h"
#include "palpable/common/base/file_format.h"
#include "palpable/common/base/output_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <map>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace palpable {
namespace {

// Gmsh's numbers of the element types that matter here.
struct ElementType {
  int number, dimension, corners, nodes;
};
constexpr std::array kTypes = {ElementType{15, 0, 1, 1}, ElementType{1, 1, 2, 2},
                               ElementType{8, 1, 2, 3},  ElementType{2, 2, 3, 3},
                               ElementType{9, 2, 3, 6},  ElementType{4, 3, 4, 4},
                               ElementType{11, 3, 4, 10}};
constexpr int kTriangle = 2, kQuadraticTriangle = 9, kTetrahedron = 4, kQuadraticTetrahedron = 11;
// Hexahedra, prisms and pyramids of orders 1 and 2, tetrahedra of higher ones: to skip them would
// leave holes in the body.
constexpr std::array kOtherSolids = {5, 6, 7, 12, 13, 14, 17, 18, 19, 29, 30, 31};

// Gmsh numbers the last two edges of a tetrahedron the other way round than kTetEdges.
constexpr int kGmshEdge[10] = {0, 1, 2, 3, 4, 5, 6, 7, 9, 8};

// The numbers of one line.
class Numbers {
 public:
  Numbers(const MeshText& text, std::string_view line) : text_(text), line_(line) {}

  template <class T>
  T next(const char* what) {
    const std::size_t begin = line_.find_first_not_of(" \t");
    if (begin == std::string_view::npos) text_.bad(fmt::format("{} is missing", what));
    line_.remove_prefix(begin);
    const std::size_t length = std::min(line_.find_first_of(" \t"), line_.size());
    const std::string_view word = line_.substr(0, length);
    line_.remove_prefix(length);
    T value{};
    const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (code != std::errc() || end != word.data() + word.size()) {
      text_.bad(fmt::format("{} is '{}', not a number", what, word.substr(0, 40)));
    }
    return value;
  }

  // A count that the rest of the file can hold.
  std::size_t count(const char* what) {
    const auto value = next<std::int64_t>(what);
    if (value < 0 || static_cast<std::uint64_t>(value) > text_.rows_left()) {
      text_.bad(fmt::format("{} is {}, more than the file holds", what, value));
    }
    return static_cast<std::size_t>(value);
  }

 private:
  const MeshText& text_;
  std::string_view line_;
};

// The type with this number; null for a type that is skipped.
const ElementType* find_type(const MeshText& text, int number) {
  if (std::find(kOtherSolids.begin(), kOtherSolids.end(), number) != kOtherSolids.end()) {
    text.bad(fmt::format(
        "an element of Gmsh's type {}; only tetrahedra of 4 or 10 nodes (types 4 and 11) are read: "
        "mesh the body with those",
        number));
  }
  for (const ElementType& type : kTypes) {
    if (type.number == number) return &type;
  }
  return nullptr;
}

class MshReader {
 public:
  explicit MshReader(std::string_view text) : text_(text) {}

  FileMesh read() {
    while (const auto line = text_.next_line()) {
      if (*line == kGmshMark) {
        read_format();
      } else if (*line == "$PhysicalNames") {
        read_names();
        end_section("$EndPhysicalNames");
      } else if (*line == "$Entities" && version_ == 4) {
        read_entities();
        end_section("$EndEntities");
      } else if (*line == "$Nodes") {
        need_format();
        version_ < 4 ? read_nodes_2() : read_nodes_4();
        end_section("$EndNodes");
      } else if (*line == "$Elements") {
        need_format();
        version_ < 4 ? read_elements_2() : read_elements_4();
        end_section("$EndElements");
      } else if (line->starts_with("$") && !line->starts_with("$End")) {
        skip_section("$End" + std::string(line->substr(1, 80)));
      } else if (version_ == 0 && !line->empty()) {
        text_.bad("not a Gmsh file: it does not begin with $MeshFormat");
      }
    }
    if (version_ == 0) text_.bad("not a Gmsh file: it has no $MeshFormat");
    if (mesh_.tets.empty() && others_ > 0) refuse_surfaces();
    return std::move(mesh_);
  }

 private:
  Numbers numbers() { return {text_, text_.need_line()}; }

  // Gmsh leaves out what is in no physical group, if there is any group.
  void refuse_surfaces() const {
    throw MeshDefect{
        0,
        fmt::format("holds no tetrahedra ({} triangles among its {} elements): where a model has "
                    "physical groups, Gmsh saves nothing else; add a Physical Volume to the .geo "
                    "file, or set Mesh.SaveAll = 1, and mesh it in 3D (gmsh -3)",
                    triangles_, others_)};
  }

  void need_format() const {
    if (version_ == 0) text_.bad("$MeshFormat does not come first");
  }

  void read_format() {
    Numbers row = numbers();
    const double version = row.next<double>("the format's version");
    if (row.next<int>("the kind of file") != 0) {
      text_.bad("a binary .msh file; save it as ASCII");
    }
    if (version != 2.2 && version != 4.1) {
      text_.bad(fmt::format("version {} of the format; 2.2 and 4.1 are read", version));
    }
    version_ = version == 2.2 ? 2 : 4;
    end_section("$EndMeshFormat");
  }

  void end_section(std::string_view end) {
    if (text_.need_line() != end) text_.bad(fmt::format("{} is missing", end));
  }

  void skip_section(const std::string& end) {
    while (const auto line = text_.next_line()) {
      if (*line == end) return;
    }
    text_.bad(fmt::format("{} is missing", end));
  }

  void read_names() {
    const std::size_t count = numbers().count("the number of names");
    for (std::size_t i = 0; i < count; ++i) {
      const std::string_view line = text_.need_line();
      Numbers row(text_, line);
      const int dimension = row.next<int>("a group's dimension");
      const auto tag = row.next<std::int64_t>("a group's number");
      const std::size_t begin = line.find('"'), end = line.rfind('"');
      if (begin == end) text_.bad("a group's name is not in quotes");
      const std::string_view name = line.substr(begin + 1, end - begin - 1);
      if (name.empty()) text_.bad("a group's name is empty");
      names_[{dimension, tag}] = std::string(name);
    }
  }

  // Version 4 keeps an entity's physical groups here and not with its elements.
  void read_entities() {
    Numbers head = numbers();
    std::array<std::size_t, 4> counts{};
    for (std::size_t& count : counts) count = head.count("the number of entities");
    for (int dimension = 0; dimension < 4; ++dimension) {
      for (std::size_t i = 0; i < counts[dimension]; ++i) {
        Numbers row = numbers();
        const auto tag = row.next<std::int64_t>("an entity's number");
        // A point's place, or the two corners of a bounding box.
        for (int k = 0; k < (dimension == 0 ? 3 : 6); ++k) (void)row.next<double>("a coordinate");
        const std::size_t groups = row.count("the number of groups");
        for (std::size_t g = 0; g < groups; ++g) {
          // The sign is that of the entity in its group.
          const auto group = row.next<std::int64_t>("a group's number");
          groups_[{dimension, tag}].push_back(group < 0 ? -group : group);
        }
      }
    }
  }

  void add_node(std::int64_t number, Numbers& row) {
    Eigen::Vector3d x;
    for (int k = 0; k < 3; ++k) x[k] = row.next<double>("a coordinate");
    if (!x.allFinite()) text_.bad(fmt::format("node {} is not a finite point", number));
    if (!mesh_.nodes.emplace(number, x).second) {
      text_.bad(fmt::format("node {} comes twice", number));
    }
  }

  [[nodiscard]] std::string group_name(int dimension, std::int64_t group) const {
    const auto named = names_.find({dimension, group});
    return named != names_.end() ? named->second : std::to_string(group);
  }

  // Adds an element. Its nodes are the next numbers in its row.
  void add_element(const ElementType& type, std::int64_t number,
                   const std::vector<std::int64_t>& groups, Numbers& row) {
    std::array<std::int64_t, 10> nodes{};
    for (int k = 0; k < type.nodes; ++k) {
      nodes[type.dimension == 3 ? kGmshEdge[k] : k] = row.next<std::int64_t>("a node number");
    }
    if (type.dimension == 3) return add_tet(type, number, groups, nodes);
    ++others_;
    if (type.dimension == 2) ++triangles_;
    for (const std::int64_t group : groups) {
      const std::string name = group_name(type.dimension, group);
      if (type.dimension == 2) {
        mesh_.face_sets[name].push_back({nodes[0], nodes[1], nodes[2]});
      } else {
        FileMesh::Nodes& set = mesh_.node_sets[name];
        if (set.line == 0) set.line = text_.line();
        set.numbers.insert(set.numbers.end(), nodes.begin(), nodes.begin() + type.nodes);
      }
    }
  }

  void add_tet(const ElementType& type, std::int64_t number,
               const std::vector<std::int64_t>& groups, const std::array<std::int64_t, 10>& nodes) {
    // Version 2 lists an element once for each of its groups.
    const auto [at, is_new] = tet_of_.try_emplace(number, static_cast<int>(mesh_.tets.size()));
    if (is_new) {
      mesh_.tets.push_back({number, text_.line(), type.nodes, nodes});
    } else if (mesh_.tets[at->second].nodes != nodes) {
      text_.bad(fmt::format("element {} comes twice, with different nodes", number));
    }
    for (const std::int64_t group : groups) {
      mesh_.tet_sets[group_name(3, group)].push_back(at->second);
    }
  }

  void read_nodes_2() {
    const std::size_t count = numbers().count("the number of nodes");
    for (std::size_t i = 0; i < count; ++i) {
      Numbers row = numbers();
      const auto tag = row.next<std::int64_t>("a node's number");
      add_node(tag, row);
    }
  }

  void read_elements_2() {
    const std::size_t count = numbers().count("the number of elements");
    for (std::size_t i = 0; i < count; ++i) {
      Numbers row = numbers();
      const auto tag = row.next<std::int64_t>("an element's number");
      const int type = row.next<int>("an element's type");
      const ElementType* known = find_type(text_, type);
      if (known == nullptr) continue;
      const std::size_t tags = row.count("the number of tags");
      std::vector<std::int64_t> groups;
      for (std::size_t k = 0; k < tags; ++k) {
        const auto group = row.next<std::int64_t>("a tag");
        if (k == 0 && group != 0) groups.push_back(group);  // 0: in no group
      }
      add_element(*known, tag, groups, row);
    }
  }

  void read_nodes_4() {
    const std::size_t blocks = numbers().count("the number of node blocks");
    for (std::size_t b = 0; b < blocks; ++b) {
      Numbers head = numbers();
      (void)head.next<int>("an entity's dimension");
      (void)head.next<std::int64_t>("an entity's number");
      (void)head.next<int>("whether nodes are parametric");
      const std::size_t count = head.count("the number of nodes");
      std::vector<std::int64_t> tags;
      for (std::size_t i = 0; i < count; ++i) {
        tags.push_back(numbers().next<std::int64_t>("a node's number"));
      }
      for (const std::int64_t tag : tags) {
        Numbers row = numbers();
        add_node(tag, row);
      }
    }
  }

  void read_elements_4() {
    const std::size_t blocks = numbers().count("the number of element blocks");
    for (std::size_t b = 0; b < blocks; ++b) {
      Numbers head = numbers();
      const int dimension = head.next<int>("an entity's dimension");
      const auto entity = head.next<std::int64_t>("an entity's number");
      const int type = head.next<int>("an element's type");
      const ElementType* known = find_type(text_, type);
      const auto groups = groups_.find({dimension, entity});
      const std::size_t count = head.count("the number of elements");
      for (std::size_t i = 0; i < count; ++i) {
        Numbers row = numbers();
        if (known == nullptr) continue;
        const auto tag = row.next<std::int64_t>("an element's number");
        add_element(*known, tag,
                    groups != groups_.end() ? groups->second : std::vector<std::int64_t>{}, row);
      }
    }
  }

  MeshText text_;
  FileMesh mesh_;
  using Key = std::pair<int, std::int64_t>;          // dimension, number
  std::map<Key, std::string> names_;                 // of groups
  std::map<Key, std::vector<std::int64_t>> groups_;  // of entities
  std::unordered_map<std::int64_t, int> tet_of_;     // by the element's number
  std::size_t others_ = 0, triangles_ = 0;           // elements that are no tetrahedra
  int version_ = 0;                                  // 2 or 4; 0 before $MeshFormat
};

// Binary files hold zero bytes; without this, they would be refused as damaged texts.
std::string why_no_msh(std::string_view first, std::uintmax_t /*size*/) {
  const std::size_t at = first.find(kGmshMark);
  if (at == std::string_view::npos) return {};
  const std::string_view line = first.substr(std::min(first.find('\n', at), first.size() - 1) + 1);
  const std::size_t kind = line.find_first_not_of(' ', line.find(' '));
  const bool is_binary = kind < line.size() && line[kind] == '1';
  return is_binary ? "line 2: a binary .msh file; save it as ASCII" : "";
}

}  // namespace

Result<VolumeMesh> parse_msh(std::string_view text, std::string_view name) {
  return read_mesh_text(text, name, [](std::string_view t) { return MshReader(t).read(); });
}

Result<VolumeMesh> read_msh_file(const std::filesystem::path& path) {
  return read_mesh_bytes(path, parse_msh, why_no_msh);
}

void write_msh_file(const std::filesystem::path& path, const TetMesh& mesh) {
  const Boundary boundary = boundary_of(mesh);
  const int triangles = boundary.surface.triangle_count();
  std::map<std::array<int, 2>, int> middles;
  for (Eigen::Index e = 0; e < mesh.edge_nodes.cols(); ++e) {
    for (int k = 0; k < 6; ++k) {
      const auto [low, high] =
          std::minmax({mesh.tets(kTetEdges[k][0], e), mesh.tets(kTetEdges[k][1], e)});
      middles[{low, high}] = mesh.edge_nodes(k, e);
    }
  }
  std::string text = fmt::format(
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"
      "$PhysicalNames\n2\n2 2 \"boundary\"\n3 1 \"body\"\n$EndPhysicalNames\n$Nodes\n{}\n",
      mesh.node_count());
  for (int n = 0; n < mesh.node_count(); ++n) {
    const auto x = mesh.nodes.col(n);  // fmt's default is the shortest text that reads back exactly
    text += fmt::format("{} {} {} {}\n", n + 1, x[0], x[1], x[2]);
  }
  text += fmt::format("$EndNodes\n$Elements\n{}\n", mesh.tet_count() + triangles);
  for (int t = 0; t < triangles; ++t) {
    std::array<int, 3> v{};
    for (int k = 0; k < 3; ++k) {
      v[k] = boundary.node_of_vertex[boundary.surface.triangles(k, t)];
    }
    text += fmt::format("{} {} 2 2 1 {} {} {}", t + 1,
                        mesh.is_quadratic() ? kQuadraticTriangle : kTriangle, v[0] + 1, v[1] + 1,
                        v[2] + 1);
    for (std::size_t k = 0; mesh.is_quadratic() && k < 3; ++k) {
      const auto [low, high] = std::minmax({v[k], v[(k + 1) % 3]});
      text += fmt::format(" {}", middles.at({low, high}) + 1);
    }
    text += '\n';
  }
  for (int e = 0; e < mesh.tet_count(); ++e) {
    const auto v = mesh.tets.col(e);
    text += fmt::format("{} {} 2 1 1 {} {} {} {}", triangles + e + 1,
                        mesh.is_quadratic() ? kQuadraticTetrahedron : kTetrahedron, v[0] + 1,
                        v[1] + 1, v[2] + 1, v[3] + 1);
    for (int k = 0; mesh.is_quadratic() && k < 6; ++k) {
      text += fmt::format(" {}", mesh.edge_nodes(kGmshEdge[k + 4] - 4, e) + 1);
    }
    text += '\n';
  }
  text += "$EndElements\n";
  write_whole_file(path, text);
}

}  // namespace palpable

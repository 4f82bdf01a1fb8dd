#include "palpable/bake/msh_file.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace palpable {
namespace {

// Gmsh's numbers of the element types that matter here.
constexpr int kTriangle = 2, kTetrahedron = 4, kQuadraticTetrahedron = 11;

// What the functions below throw; it never leaves this file.
struct Bad {
  std::size_t line;
  std::string what;
};

// The text, word by word, with the line for messages.
class Text {
 public:
  explicit Text(std::string_view text) : rest_(text) {}

  // The next line, without its end; nothing at the end of the text.
  std::optional<std::string_view> next_line() {
    if (rest_.empty()) return std::nullopt;
    const std::size_t end = std::min(rest_.find('\n'), rest_.size());
    std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    ++line_;
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line;
  }

  std::string_view need_line() {
    const auto line = next_line();
    if (!line) bad("the file ends too early");
    return *line;
  }

  // Upper bound of how many rows may follow: each needs at least two bytes.
  [[nodiscard]] std::size_t rows_left() const { return rest_.size() / 2 + 1; }

  [[nodiscard]] std::size_t line() const { return line_; }

  [[noreturn]] void bad(std::string what) const { throw Bad{line_, std::move(what)}; }

 private:
  std::string_view rest_;
  std::size_t line_ = 0;
};

// The numbers of one line.
class Numbers {
 public:
  Numbers(const Text& text, std::string_view line) : text_(text), line_(line) {}

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
  const Text& text_;
  std::string_view line_;
};

struct Element {
  std::int64_t tag;
  std::size_t line;
  std::int64_t nodes[4];
};

struct Content {
  std::unordered_map<std::int64_t, Eigen::Vector3d> nodes;
  std::vector<Element> tets;
};

void add_node(const Text& text, Content& content, std::int64_t tag, Numbers& numbers) {
  Eigen::Vector3d x;
  for (int k = 0; k < 3; ++k) x[k] = numbers.next<double>("a coordinate");
  if (!x.allFinite()) text.bad(fmt::format("node {} is not a finite point", tag));
  if (!content.nodes.emplace(tag, x).second) text.bad(fmt::format("node {} comes twice", tag));
}

void check_type(const Text& text, int type) {
  if (type == kQuadraticTetrahedron) {
    text.bad("quadratic tetrahedra; save the mesh with element order 1");
  }
}

void add_tet(Content& content, std::int64_t tag, std::size_t line, Numbers& numbers) {
  Element element{tag, line, {}};
  for (std::int64_t& node : element.nodes) node = numbers.next<std::int64_t>("a node number");
  content.tets.push_back(element);
}

class MshReader {
 public:
  explicit MshReader(std::string_view text) : text_(text) {}

  Content read() {
    while (const auto line = text_.next_line()) {
      if (*line == "$MeshFormat") {
        read_format();
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
    return std::move(content_);
  }

 private:
  Numbers numbers() { return {text_, text_.need_line()}; }

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

  void read_nodes_2() {
    const std::size_t count = numbers().count("the number of nodes");
    for (std::size_t i = 0; i < count; ++i) {
      Numbers row = numbers();
      const auto tag = row.next<std::int64_t>("a node's number");
      add_node(text_, content_, tag, row);
    }
  }

  void read_elements_2() {
    const std::size_t count = numbers().count("the number of elements");
    for (std::size_t i = 0; i < count; ++i) {
      Numbers row = numbers();
      const auto tag = row.next<std::int64_t>("an element's number");
      const int type = row.next<int>("an element's type");
      check_type(text_, type);
      if (type != kTetrahedron) continue;
      const std::size_t tags = row.count("the number of tags");
      for (std::size_t k = 0; k < tags; ++k) (void)row.next<std::int64_t>("a tag");
      add_tet(content_, tag, text_.line(), row);
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
        add_node(text_, content_, tag, row);
      }
    }
  }

  void read_elements_4() {
    const std::size_t blocks = numbers().count("the number of element blocks");
    for (std::size_t b = 0; b < blocks; ++b) {
      Numbers head = numbers();
      (void)head.next<int>("an entity's dimension");
      (void)head.next<std::int64_t>("an entity's number");
      const int type = head.next<int>("an element's type");
      check_type(text_, type);
      const std::size_t count = head.count("the number of elements");
      for (std::size_t i = 0; i < count; ++i) {
        Numbers row = numbers();
        if (type != kTetrahedron) continue;
        const auto tag = row.next<std::int64_t>("an element's number");
        add_tet(content_, tag, text_.line(), row);
      }
    }
  }

  Text text_;
  Content content_;
  int version_ = 0;  // 2 or 4; 0 before $MeshFormat
};

TetMesh make_mesh(const Content& content) {
  if (content.tets.empty()) {
    throw Bad{0, "holds no tetrahedra; make some from a surface with 'palpable mesh'"};
  }
  TetMesh mesh;
  mesh.tets.resize(4, static_cast<Eigen::Index>(content.tets.size()));
  std::unordered_map<std::int64_t, int> number_of;
  std::vector<Eigen::Vector3d> nodes;
  for (std::size_t e = 0; e < content.tets.size(); ++e) {
    const Element& tet = content.tets[e];
    for (int k = 0; k < 4; ++k) {
      const auto at = content.nodes.find(tet.nodes[k]);
      if (at == content.nodes.end()) {
        throw Bad{tet.line, fmt::format("tetrahedron {} has a corner {} that is not a node",
                                        tet.tag, tet.nodes[k])};
      }
      const auto [number, is_new] =
          number_of.try_emplace(tet.nodes[k], static_cast<int>(nodes.size()));
      if (is_new) nodes.push_back(at->second);
      mesh.tets(k, static_cast<Eigen::Index>(e)) = number->second;
    }
  }
  mesh.nodes.resize(3, static_cast<Eigen::Index>(nodes.size()));
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    mesh.nodes.col(static_cast<Eigen::Index>(i)) = nodes[i];
  }
  const Eigen::VectorXd volumes = tet_volumes(mesh);
  int bad_count = 0;
  std::size_t first = 0;
  for (std::size_t e = content.tets.size(); e-- > 0;) {
    if (volumes[static_cast<Eigen::Index>(e)] > 0.0) continue;
    ++bad_count;
    first = e;
  }
  if (bad_count > 0) {
    const double volume = volumes[static_cast<Eigen::Index>(first)];
    throw Bad{content.tets[first].line,
              fmt::format("{} of {} tetrahedra {} inverted or flat, the first is number {} with a "
                          "volume of {:.3g}; mesh the surface again, or swap two of its nodes",
                          bad_count, content.tets.size(), bad_count == 1 ? "is" : "are",
                          content.tets[first].tag, volume)};
  }
  return mesh;
}

}  // namespace

Result<TetMesh> parse_msh(std::string_view text, std::string_view name) {
  try {
    return make_mesh(MshReader(text).read());
  } catch (const Bad& bad) {
    if (bad.line == 0) return Problem{fmt::format("{}: {}", name, bad.what)};
    return Problem{fmt::format("{}: line {}: {}", name, bad.line, bad.what)};
  } catch (const std::bad_alloc&) {
    return Problem{fmt::format("{}: needs more memory than there is", name)};
  }
}

Result<TetMesh> read_msh_file(const std::filesystem::path& path) {
  std::error_code code;
  if (!std::filesystem::is_regular_file(path, code)) {
    return Problem{fmt::format("{}: no such file", path.string())};
  }
  std::ifstream file(path, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  if (!file) return Problem{fmt::format("{}: cannot be read", path.string())};
  return parse_msh(text, path.string());
}

void write_msh_file(const std::filesystem::path& path, const TetMesh& mesh) {
  const Boundary boundary = boundary_of(mesh);
  const int triangles = boundary.surface.triangle_count();
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
    const auto node = [&](int k) {
      return boundary.node_of_vertex[static_cast<std::size_t>(boundary.surface.triangles(k, t))] +
             1;
    };
    text += fmt::format("{} {} 2 2 1 {} {} {}\n", t + 1, kTriangle, node(0), node(1), node(2));
  }
  for (int e = 0; e < mesh.tet_count(); ++e) {
    const auto v = mesh.tets.col(e);
    text += fmt::format("{} {} 2 1 1 {} {} {} {}\n", triangles + e + 1, kTetrahedron, v[0] + 1,
                        v[1] + 1, v[2] + 1, v[3] + 1);
  }
  text += "$EndElements\n";
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) throw Error(fmt::format("{}: cannot be written", path.string()));
}

}  // namespace palpable

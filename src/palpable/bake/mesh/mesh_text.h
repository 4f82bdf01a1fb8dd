/// @file
/// Helpers of the readers of mesh texts (.msh, .inp): numbered lines, and the renumbering of a
/// file's nodes and elements.
#pragma once

#include "palpable/bake/mesh/volume_mesh.h"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace palpable {

/// An error in a mesh text, and its line (0: none). Thrown within the readers; read_mesh_text()
/// turns it into a Problem.
struct MeshDefect {
  std::size_t line;
  std::string what;
};

/// A text, line by line.
class MeshText {
 public:
  explicit MeshText(std::string_view text) : rest_(text) {}

  /// The next line, without its end; nothing at the end of the text.
  std::optional<std::string_view> next_line();
  /// The same; it is an error if there is none.
  std::string_view need_line();

  /// Upper bound of the number of rows that may follow: each needs at least two bytes.
  [[nodiscard]] std::size_t rows_left() const { return rest_.size() / 2 + 1; }
  [[nodiscard]] std::size_t line() const { return line_; }
  [[noreturn]] void bad(std::string what) const;

 private:
  std::string_view rest_;
  std::size_t line_ = 0;
};

/// A mesh with the numbers that nodes and elements have in the file.
struct FileMesh {
  struct Tet {
    std::int64_t number;
    std::size_t line;
    int node_count;                      // 4 or 10
    std::array<std::int64_t, 10> nodes;  // corners, then edges as in kTetEdges
  };
  struct Nodes {
    std::size_t line = 0;  // where the set begins
    std::vector<std::int64_t> numbers;
  };
  std::unordered_map<std::int64_t, Eigen::Vector3d> nodes;
  std::vector<Tet> tets;
  std::map<std::string, Nodes> node_sets;
  std::map<std::string, std::vector<int>> tet_sets;  // indices into tets
  std::map<std::string, std::vector<std::array<std::int64_t, 3>>> face_sets;
  std::map<std::string, std::string> unusable;  // of MeshSets
};

/// Renumbers nodes and elements: nodes in the order in which tetrahedra use them; unused nodes are
/// dropped.
/// Tetrahedra whose order alone is inverted are turned (turn_inverted()), which VolumeMesh::repair
/// says.
/// @throws MeshDefect for no tetrahedra, tetrahedra of both kinds or with a corner that is not a
///         node, others that are inverted or flat (by their corners), two with the same corners, a
///         set with a node that does not exist
[[nodiscard]] VolumeMesh number_anew(const FileMesh& file);

/// Largest mesh text that is read, bytes: ten million elements of ten nodes, which no equilibrium
/// path is computed on.
inline constexpr std::uintmax_t kLargestMeshText = 1'000'000'000;

/// Runs a reader on a text; its MeshDefect becomes a problem that names the file and the line.
/// @param place  "file: line 12" of a line, where the text consists of several files
[[nodiscard]] Result<VolumeMesh> read_mesh_text(
    std::string_view text, std::string_view name,
    const std::function<FileMesh(std::string_view text)>& reader,
    const std::function<std::string(std::size_t line)>& place = {});

/// Reads a text as plain_text() and passes it and its name to `parse`.
/// @param why_not  judges the first bytes, see FileBound
[[nodiscard]] Result<VolumeMesh> read_mesh_bytes(
    const std::filesystem::path& path,
    const std::function<Result<VolumeMesh>(std::string_view text, std::string_view name)>& parse,
    const std::function<std::string(std::string_view first, std::uintmax_t size)>& why_not = {});

}  // namespace palpable

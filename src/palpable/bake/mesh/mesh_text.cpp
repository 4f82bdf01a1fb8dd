#include "palpable/bake/mesh/mesh_text.h"

#include "palpable/bake/mesh/turned_tets.h"
#include "palpable/common/base/whole_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <new>
#include <utility>

namespace palpable {

std::optional<std::string_view> MeshText::next_line() {
  if (rest_.empty()) return std::nullopt;
  const std::size_t end = std::min(rest_.find('\n'), rest_.size());
  std::string_view line = rest_.substr(0, end);
  rest_.remove_prefix(std::min(end + 1, rest_.size()));
  ++line_;
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

std::string_view MeshText::need_line() {
  const auto line = next_line();
  if (!line) bad("the file ends too early");
  return *line;
}

void MeshText::bad(std::string what) const { throw MeshDefect{line_, std::move(what)}; }

namespace {

void refuse_inverted(const TetMesh& mesh, const FileMesh& file) {
  const Eigen::VectorXd volumes = tet_volumes(mesh);
  int bad_count = 0;
  std::size_t first = 0;
  for (std::size_t e = file.tets.size(); e-- > 0;) {
    if (volumes[static_cast<Eigen::Index>(e)] > 0.0) continue;
    ++bad_count;
    first = e;
  }
  if (bad_count == 0) return;
  throw MeshDefect{
      file.tets[first].line,
      fmt::format("{} of {} tetrahedra {} inverted or flat, the first is number {} with a "
                  "volume of {:.3g}, and not by its order alone; mesh the surface again",
                  bad_count, file.tets.size(), bad_count == 1 ? "is" : "are",
                  file.tets[first].number, volumes[static_cast<Eigen::Index>(first)])};
}

// The new number of each node of the file that an element uses.
using NewNumbers = std::unordered_map<std::int64_t, int>;

// The elements and the nodes that they use, in the order in which they first do.
VolumeMesh numbered_elements(const FileMesh& file, NewNumbers& number_of) {
  VolumeMesh volume;
  TetMesh& mesh = volume.mesh;
  const int node_count = file.tets.front().node_count;
  const auto tet_count = static_cast<Eigen::Index>(file.tets.size());
  mesh.tets.resize(4, tet_count);
  mesh.edge_nodes.resize(6, node_count == 10 ? tet_count : 0);
  std::vector<Eigen::Vector3d> nodes;
  for (Eigen::Index e = 0; e < tet_count; ++e) {
    const FileMesh::Tet& tet = file.tets[e];
    if (tet.node_count != node_count) {
      throw MeshDefect{tet.line, fmt::format("tetrahedron {} has {} nodes, those before have {}; "
                                             "mesh the body with elements of one order",
                                             tet.number, tet.node_count, node_count)};
    }
    for (int k = 0; k < node_count; ++k) {
      const std::int64_t node = tet.nodes[k];
      const auto at = file.nodes.find(node);
      if (at == file.nodes.end()) {
        throw MeshDefect{tet.line, fmt::format("tetrahedron {} has a {} {} that is not a node",
                                               tet.number, k < 4 ? "corner" : "middle node", node)};
      }
      const auto [number, is_new] = number_of.try_emplace(node, static_cast<int>(nodes.size()));
      if (is_new) {
        nodes.push_back(at->second);
        volume.numbers.push_back(node);
      }
      (k < 4 ? mesh.tets(k, e) : mesh.edge_nodes(k - 4, e)) = number->second;
    }
  }
  mesh.nodes.resize(3, static_cast<Eigen::Index>(nodes.size()));
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    mesh.nodes.col(static_cast<Eigen::Index>(i)) = nodes[i];
  }
  return volume;
}

// The same corners in any order: such an element would count twice, with twice the stiffness.
void refuse_twins(const FileMesh& file) {
  using Corners = std::array<std::int64_t, 4>;
  std::vector<std::pair<Corners, std::size_t>> all;
  all.reserve(file.tets.size());
  for (std::size_t e = 0; e < file.tets.size(); ++e) {
    Corners corners{};
    std::copy_n(file.tets[e].nodes.begin(), corners.size(), corners.begin());
    std::sort(corners.begin(), corners.end());
    all.emplace_back(corners, e);
  }
  std::sort(all.begin(), all.end());
  const auto twin = std::adjacent_find(
      all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first == b.first; });
  if (twin == all.end()) return;
  const FileMesh::Tet& first = file.tets[twin->second];
  const FileMesh::Tet& second = file.tets[std::next(twin)->second];
  throw MeshDefect{second.line,
                   fmt::format("tetrahedra {} and {} have the same corners ({}): one would count "
                               "twice; leave one of them out",
                               first.number, second.number, fmt::join(twin->first, ", "))};
}

void sort_without_doubles(std::vector<int>& numbers) {
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

// The file's sets, without the nodes and faces that no element uses.
MeshSets numbered_sets(const FileMesh& file, const NewNumbers& number_of) {
  MeshSets sets;
  for (const auto& [name, set] : file.node_sets) {
    std::vector<int>& numbers = sets.nodes[name];
    for (const std::int64_t node : set.numbers) {
      if (!file.nodes.contains(node)) {
        throw MeshDefect{set.line,
                         fmt::format("the set '{}' has a node {} that does not exist", name, node)};
      }
      const auto used = number_of.find(node);
      if (used != number_of.end()) numbers.push_back(used->second);
    }
    sort_without_doubles(numbers);
  }
  for (auto [name, numbers] : file.tet_sets) {
    sort_without_doubles(numbers);
    sets.tets[name] = std::move(numbers);
  }
  for (const auto& [name, faces] : file.face_sets) {
    std::vector<Eigen::Vector3i>& kept = sets.faces[name];
    for (const auto& face : faces) {
      Eigen::Vector3i corners;
      bool used = true;
      for (int k = 0; k < 3; ++k) {
        const auto at = number_of.find(face[k]);
        used = used && at != number_of.end();
        if (used) corners[k] = at->second;
      }
      if (used) kept.push_back(corners);
    }
  }
  sets.unusable = file.unusable;
  return sets;
}

}  // namespace

VolumeMesh number_anew(const FileMesh& file) {
  if (file.tets.empty()) {
    throw MeshDefect{0, "holds no tetrahedra; make some from a surface with 'palpable mesh'"};
  }
  NewNumbers number_of;
  VolumeMesh volume = numbered_elements(file, number_of);
  if (const int turned = turn_inverted(volume.mesh); turned > 0) {
    volume.repair = fmt::format(
        "repaired: {} of {} tetrahedra turned, whose nodes had the other order; all now fill a "
        "volume of {:.6g} (in the file's lengths)",
        turned, volume.mesh.tet_count(), tet_volumes(volume.mesh).sum());
  }
  refuse_inverted(volume.mesh, file);
  refuse_twins(file);
  volume.sets = numbered_sets(file, number_of);
  return volume;
}

Result<VolumeMesh> read_mesh_text(std::string_view text, std::string_view name,
                                  const std::function<FileMesh(std::string_view)>& reader,
                                  const std::function<std::string(std::size_t)>& place) {
  try {
    return number_anew(reader(text));
  } catch (const MeshDefect& bad) {
    if (bad.line == 0) return Problem{fmt::format("{}: {}", name, bad.what)};
    const std::string where = place ? place(bad.line) : fmt::format("{}: line {}", name, bad.line);
    return Problem{fmt::format("{}: {}", where, bad.what)};
  } catch (const std::bad_alloc&) {
    return Problem{fmt::format("{}: needs more memory than there is", name)};
  }
}

Result<VolumeMesh> read_mesh_bytes(
    const std::filesystem::path& path,
    const std::function<Result<VolumeMesh>(std::string_view, std::string_view)>& parse,
    const std::function<std::string(std::string_view, std::uintmax_t)>& why_not) {
  const Result<std::string> text =
      read_text_file(path, {.most = kLargestMeshText, .why_not = why_not});
  if (!text) return Problem{fmt::format("{}: {}", path.string(), text.problem().message)};
  return parse(text.value(), path.string());
}

}  // namespace palpable

#include "palpable/bake/describe/places.h"

#include "palpable/bake/solid/selection.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/nearest_word.h"
#include "palpable/common/geometry/size_text.h"
#include "palpable/common/geometry/surface_distance.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <utility>

namespace palpable {
namespace {

constexpr double kNoLimit = std::numeric_limits<double>::infinity();

// Number of mean edges of the skin that a named point may be away from the body. Nearest nodes are
// within one edge of every point of the skin, a remeshed or wrapped skin within another one of the
// surface that the user looked at.
constexpr double kFarthestPoint = 3.0;

// Runs `choose`; its errors begin with the place.
template <class Choose>
auto at_place(const Where& where, const Choose& choose) {
  try {
    return choose();
  } catch (const Error& error) { throw Error(fmt::format("{}: {}", where.place, error.what())); }
}

bool same_name(const std::string& a, const std::string& b) {
  const auto lower = [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [&](char x, char y) { return lower(x) == lower(y); });
}

// The set of that name, else one whose name differs in case only, which is the same name in Abaqus.
template <class Sets>
const typename Sets::mapped_type* find_set(const Sets& sets, const std::string& name) {
  if (const auto exact = sets.find(name); exact != sets.end()) return &exact->second;
  for (const auto& [other, content] : sets) {
    if (same_name(other, name)) return &content;
  }
  return nullptr;
}

// Throws an error that names the sets that exist instead of `name`. @param wanted  e.g. "nodes or
// faces"
[[noreturn]] void refuse_name(const MeshSets& sets, const std::string& name,
                              const std::string& wanted, const std::vector<std::string>& known) {
  if (const std::string* why = find_set(sets.unusable, name)) {
    throw Error(fmt::format("the mesh's set '{}' cannot be used: {}", name, *why));
  }
  const bool other_kind = find_set(sets.nodes, name) != nullptr ||
                          find_set(sets.tets, name) != nullptr ||
                          find_set(sets.faces, name) != nullptr;
  if (known.empty()) {
    throw Error(fmt::format("the mesh has no sets of {}{}", wanted,
                            other_kind ? fmt::format("; '{}' is of another kind", name) : ""));
  }
  const std::string guess = nearest_word(name, known);
  throw Error(fmt::format(
      "{} '{}'; {}",
      other_kind ? fmt::format("the mesh has no set of {}", wanted)
                 : std::string("the mesh has no set"),
      name,
      guess.empty() ? fmt::format("its sets of {} are '{}'", wanted, fmt::join(known, "', '"))
                    : fmt::format("did you mean '{}'?", guess)));
}

template <class... Sets>
std::vector<std::string> names_of(const Sets&... sets) {
  std::set<std::string> names;
  (
      [&] {
        for (const auto& [name, content] : sets) names.insert(name);
      }(),
      ...);
  return {names.begin(), names.end()};
}

// Z at a fraction of the height, from the lowest node.
double level_of(const TetMesh& mesh, double fraction) {
  const double low = mesh.nodes.row(2).minCoeff(), high = mesh.nodes.row(2).maxCoeff();
  return low + fraction * (high - low);
}

std::vector<int> corners_of(const std::vector<Eigen::Vector3i>& faces) {
  std::vector<int> nodes;
  for (const Eigen::Vector3i& face : faces) nodes.insert(nodes.end(), face.begin(), face.end());
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

struct NodesAt {
  const VolumeMesh& volume;

  // Never empty: the lowest or the highest node is always there.
  std::vector<int> operator()(const Where::Below& below) const {
    return nodes_in_box(volume.mesh, Eigen::Vector3d::Constant(-kNoLimit),
                        {kNoLimit, kNoLimit, level_of(volume.mesh, below.fraction)});
  }
  std::vector<int> operator()(const Where::Above& above) const {
    return nodes_in_box(volume.mesh, {-kNoLimit, -kNoLimit, level_of(volume.mesh, above.fraction)},
                        Eigen::Vector3d::Constant(kNoLimit));
  }
  std::vector<int> operator()(const Where::Plane& plane) const {
    const Eigen::Vector3d size = extent_of(volume.mesh.nodes);
    return nodes_on_plane(volume.mesh, plane.point, plane.normal,
                          plane.distance.value_or(1e-6 * size.norm()));
  }
  std::vector<int> operator()(const Where::Box& box) const {
    return nodes_in_box(volume.mesh, box.low, box.high);
  }
  std::vector<int> operator()(const Where::Nearest& nearest) const {
    refuse_far_points(volume.mesh, nearest.points, PointsMayLie::kAlsoInside);
    std::vector<int> nodes;
    for (const Eigen::Vector3d& point : nearest.points) {
      nodes.push_back(nearest_node(volume.mesh, point));
    }
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    return nodes;
  }
  std::vector<int> operator()(const Where::Named& set) const {
    const auto* nodes = find_set(volume.sets.nodes, set.name);
    const auto* faces = find_set(volume.sets.faces, set.name);
    if (nodes == nullptr && faces == nullptr) {
      refuse_name(volume.sets, set.name, "nodes or faces",
                  names_of(volume.sets.nodes, volume.sets.faces));
    }
    std::vector<int> all;
    if (faces != nullptr) all = with_edge_middles(volume.mesh, corners_of(*faces));
    if (nodes != nullptr) all.insert(all.end(), nodes->begin(), nodes->end());
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    if (all.empty()) {
      throw Error(fmt::format("the set '{}' is empty: none of its nodes belongs to a tetrahedron",
                              set.name));
    }
    return all;
  }
};

struct TetsAt {
  const VolumeMesh& volume;

  template <class Inside>
  [[nodiscard]] std::vector<int> where_middle(const Inside& inside) const {
    const TetMesh& mesh = volume.mesh;
    std::vector<int> tets;
    for (int e = 0; e < mesh.tet_count(); ++e) {
      const Eigen::Vector3d middle = mesh.nodes(Eigen::all, mesh.tets.col(e)).rowwise().mean();
      if (inside(middle)) tets.push_back(e);
    }
    if (tets.empty()) {
      const Eigen::Vector3d low = mesh.nodes.rowwise().minCoeff();
      const Eigen::Vector3d high = mesh.nodes.rowwise().maxCoeff();
      throw Error(
          fmt::format("no element has its middle there; the body reaches from ({:.4g}, "
                      "{:.4g}, {:.4g}) to ({:.4g}, {:.4g}, {:.4g}) m",
                      low[0], low[1], low[2], high[0], high[1], high[2]));
    }
    return tets;
  }

  std::vector<int> operator()(const Where::Below& below) const {
    const double limit = level_of(volume.mesh, below.fraction);
    return where_middle([&](const Eigen::Vector3d& X) { return X[2] <= limit; });
  }
  std::vector<int> operator()(const Where::Above& above) const {
    const double limit = level_of(volume.mesh, above.fraction);
    return where_middle([&](const Eigen::Vector3d& X) { return X[2] > limit; });
  }
  std::vector<int> operator()(const Where::Plane& plane) const {
    return where_middle(
        [&](const Eigen::Vector3d& X) { return plane.normal.dot(X - plane.point) > 0.0; });
  }
  std::vector<int> operator()(const Where::Box& box) const {
    return where_middle([&](const Eigen::Vector3d& X) {
      return (X.array() >= box.low.array()).all() && (X.array() <= box.high.array()).all();
    });
  }
  std::vector<int> operator()(const Where::Nearest& /*points*/) const {
    PALPABLE_EXPECT(false, "elements are not chosen by points");
    return {};
  }
  std::vector<int> operator()(const Where::Named& set) const {
    const auto* tets = find_set(volume.sets.tets, set.name);
    if (tets == nullptr) {
      refuse_name(volume.sets, set.name, "elements", names_of(volume.sets.tets));
    }
    if (tets->empty()) throw Error(fmt::format("the set '{}' is empty", set.name));
    return *tets;
  }
};

// The triangles of the skin that are in the set, whatever their orientation in the set.
Eigen::Matrix3Xi of_skin(const Eigen::Matrix3Xi& skin, const std::vector<Eigen::Vector3i>& faces) {
  const auto key = [](auto face) {
    std::array<int, 3> nodes{face[0], face[1], face[2]};
    std::sort(nodes.begin(), nodes.end());
    return nodes;
  };
  std::set<std::array<int, 3>> wanted;
  for (const Eigen::Vector3i& face : faces) wanted.insert(key(face));
  std::vector<Eigen::Index> kept;
  for (Eigen::Index t = 0; t < skin.cols(); ++t) {
    if (wanted.contains(key(skin.col(t)))) kept.push_back(t);
  }
  if (kept.empty()) throw Error("none of the faces of the set is on the skin of the body");
  return skin(Eigen::all, kept);
}

}  // namespace

void refuse_far_points(const TetMesh& mesh, std::span<const Eigen::Vector3d> points,
                       PointsMayLie where) {
  const SurfaceDistance skin(boundary_of(mesh).surface);
  const double edge = mean_edge_length(skin.surface());
  for (const Eigen::Vector3d& point : points) {
    const double distance = skin.nearest(point).distance;
    const bool allowed = distance < 0.0 && where == PointsMayLie::kAlsoInside;
    if (allowed || std::abs(distance) <= kFarthestPoint * edge) continue;
    throw Error(fmt::format(
        "the point ({:.4g}, {:.4g}, {:.4g}) m lies {:.4g} mm {} the body's skin, whose edges are "
        "{:.3g} mm long: look at the unit of its lengths, and at the body frame (the body stands "
        "on Z = 0, its middle above the origin)",
        point[0], point[1], point[2], 1e3 * std::abs(distance),
        distance < 0.0 ? "inside" : "outside", 1e3 * edge));
  }
}

std::vector<int> nodes_at(const VolumeMesh& volume, const Where& where) {
  return at_place(where, [&] { return std::visit(NodesAt{volume}, where.what); });
}

std::vector<int> tets_at(const VolumeMesh& volume, const Where& where) {
  return at_place(where, [&] { return std::visit(TetsAt{volume}, where.what); });
}

Eigen::Matrix3Xi faces_at(const VolumeMesh& volume, const Where& where) {
  return at_place(where, [&]() -> Eigen::Matrix3Xi {
    const Eigen::Matrix3Xi skin = skin_triangles(volume.mesh);
    if (const auto* set = std::get_if<Where::Named>(&where.what)) {
      if (const auto* faces = find_set(volume.sets.faces, set->name)) {
        return of_skin(skin, *faces);
      }
    }
    return triangles_between(skin, std::visit(NodesAt{volume}, where.what));
  });
}

}  // namespace palpable

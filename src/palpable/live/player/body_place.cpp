#include "palpable/live/player/body_place.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/geometry/size_text.h"
#include "palpable/common/geometry/surface_distance.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstddef>
#include <utility>

namespace palpable {
namespace {

constexpr double kStandsIn = 2e-4;  // m: bodies that stand on each other touch up to rounding
// m. Points this far below the skin are tested too: two bodies in the same place have the same
// skin, so that no vertex of one is inside the other.
constexpr float kBelow = 1e-3f;

Eigen::AlignedBox3d box_in_world(const PlacedBody& body) {
  Eigen::AlignedBox3d box;
  const Eigen::Matrix3Xd& x = body.body.body.surface.vertices;
  for (Eigen::Index v = 0; v < x.cols(); ++v) {
    box.extend(Eigen::Vector3d(body.world_from_body * x.col(v)));
  }
  return box;
}

// Largest penetration, m, of a point of `a` into `b`. The points are the vertices, the points
// kBelow under them and the triangles' centres.
double entry_of(const PlacedBody& a, const PlacedBody& b) {
  const SurfaceMesh& skin = a.body.body.surface;
  const Eigen::AlignedBox3d near = box_in_world(b);
  std::optional<SurfaceDistance> distance;  // constructed when first needed
  const Rigid3 b_from_world = b.world_from_body.inverse();
  double deepest = 0;
  const auto look = [&](const Eigen::Vector3d& x_in_a) {
    const Eigen::Vector3d x = a.world_from_body * x_in_a;
    if (!near.contains(x)) return;
    if (!distance) distance.emplace(b.body.body.surface);
    deepest = std::max(deepest, -distance->nearest(b_from_world * x).distance);
  };
  const Eigen::Matrix3Xf vertices = skin.vertices.cast<float>();
  Eigen::Matrix3Xf normals(3, vertices.cols());
  vertex_normals(vertices, skin.triangles, normals);
  for (Eigen::Index v = 0; v < skin.vertices.cols(); ++v) {
    look(skin.vertices.col(v));
    look((vertices.col(v) - kBelow * normals.col(v)).cast<double>());
  }
  for (Eigen::Index t = 0; t < skin.triangles.cols(); ++t) {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (int k = 0; k < 3; ++k) middle += skin.vertices.col(skin.triangles(k, t)) / 3;
    look(middle);
  }
  return deepest;
}

}  // namespace

std::vector<Rigid3> world_from_bodies(const std::vector<BodyPlace>& places, Anchor of_run,
                                      const std::function<Rigid3(Anchor)>& world_from_anchor) {
  std::vector<Rigid3> all;
  for (const BodyPlace& at : places) {
    PALPABLE_EXPECT(at.beside < std::ssize(all), "a body stands beside an earlier one");
    Rigid3 world_from_base;
    if (at.beside >= 0) {
      world_from_base = all[static_cast<std::size_t>(at.beside)];
    } else if (at.place) {
      world_from_base = *at.place;
    } else {
      world_from_base = world_from_anchor(at.anchor.value_or(of_run));
    }
    // Without a shift the pose is exactly that of the anchor.
    const bool shifted = !at.anchor_from_body.matrix().isIdentity(0);
    all.push_back(shifted ? world_from_base * at.anchor_from_body : world_from_base);
  }
  return all;
}

Footprint footprint_of(const std::vector<BodyPlace>& places,
                       const std::vector<const SurfaceMesh*>& skins, Anchor of_run) {
  PALPABLE_EXPECT(places.size() == skins.size(), "each place is of a body");
  const std::vector<Rigid3> anchor_from_bodies =
      world_from_bodies(places, of_run, [](Anchor) { return Rigid3::Identity(); });
  Footprint room;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const BodyPlace* base = &places[k];
    while (base->beside >= 0) base = &places[static_cast<std::size_t>(base->beside)];
    if (base->place || base->anchor.value_or(of_run) != Anchor::kPlane) continue;
    for (const auto& vertex : skins[k]->vertices.colwise()) {
      const Eigen::Vector3d at = anchor_from_bodies[k] * Eigen::Vector3d(vertex);
      room.radius = std::max(room.radius, std::hypot(at.x(), at.y()));
      room.height = std::max(room.height, at.z());
    }
  }
  room.radius = std::min(room.radius, 1.0);
  return room;
}

std::vector<PlacedBody> placed(std::vector<LiveBody> bodies, Anchor of_run,
                               const std::function<Rigid3(Anchor)>& world_from_anchor) {
  std::vector<BodyPlace> places;
  for (const LiveBody& body : bodies) places.push_back(body.place);
  const std::vector<Rigid3> stand = world_from_bodies(places, of_run, world_from_anchor);
  std::vector<PlacedBody> all;
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    LiveBody& body = bodies[k];
    all.push_back({std::move(body.body), stand[k], std::move(body.name), body.color});
  }
  return all;
}

std::optional<std::string> overlap_of(const std::vector<PlacedBody>& bodies) {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (!box_in_world(bodies[i]).intersects(box_in_world(bodies[j]))) continue;
      const double entry = std::max(entry_of(bodies[i], bodies[j]), entry_of(bodies[j], bodies[i]));
      if (!(entry > kStandsIn)) continue;
      return fmt::format(
          "'{}' stands in '{}', by {:.1f} mm; move one of them, as by at = [\"150 mm\", \"0 mm\", "
          "\"0 mm\"]",
          bodies[i].shown_name(), bodies[j].shown_name(), 1e3 * entry);
    }
  }
  return std::nullopt;
}

std::optional<std::string> larger_than_view(const SurfaceMesh& body, const Rigid3& camera_from_body,
                                            const PinholeCamera& camera) {
  const double depth = camera_from_body.translation().z();  // of the centre of its base
  if (!(depth > 0.0)) return std::nullopt;
  const Eigen::Vector3d size = extent_of(body.vertices);
  const Eigen::Vector2d seen(depth * camera.width / camera.fx_px,
                             depth * camera.height / camera.fy_px);
  if (size.maxCoeff() <= seen.maxCoeff()) return std::nullopt;
  return fmt::format(
      "the body is {}, larger than what the camera sees where it stands ({} at {:.3g} m): was its "
      "unit forgotten when it was baked?",
      size_text(size), size_text(seen), depth);
}

std::optional<std::string> outside_of_view(const SurfaceMesh& body, const Rigid3& camera_from_body,
                                           const PinholeCamera& camera) {
  for (const auto& vertex : body.vertices.colwise()) {
    const Eigen::Vector3d x = camera_from_body * Eigen::Vector3d(vertex);
    if (!(x.z() > 0)) continue;
    const Eigen::Vector2d pixel = camera.project(x);
    if (pixel.x() >= 0 && pixel.x() < camera.width && pixel.y() >= 0 && pixel.y() < camera.height) {
      return std::nullopt;
    }
  }
  const Eigen::Vector3d base = camera_from_body.translation();
  return fmt::format(
      "the camera does not see where the body stands: {:.3g} m to the right, {:.3g} m down, {:.3g} "
      "m "
      "forward of it",
      base.x(), base.y(), base.z());
}

}  // namespace palpable

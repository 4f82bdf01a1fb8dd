#include "palpable/desk/score/touched_places.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/geometry/surface_distance.h"
#include "palpable/desk/score/deepest_sample.h"

#include <algorithm>

namespace palpable {

using Eigen::Vector3d;

namespace {

struct TouchedSample {
  Vector3d at_rest;
  double moved = 0;  // m
};

std::vector<TouchedSample> samples_of(const SurfaceMesh& rest, const SurfaceMesh& deformed,
                                      std::span<const Capsule> hand) {
  std::vector<TouchedSample> touched;
  for (const Capsule& capsule : hand) {
    for (Eigen::Index t = 0; t < deformed.triangles.cols(); ++t) {
      const auto corner = deformed.triangles.col(t);
      const Vector3d a = deformed.vertices.col(corner[0]);
      const Vector3d b = deformed.vertices.col(corner[1]);
      const Vector3d c = deformed.vertices.col(corner[2]);
      DeepestSample sample(capsule, -kTouches);
      if (!sample.look_at(a, b, c)) continue;
      const Vector3d weights = nearest_weights(a, b, c, sample.point());
      const Vector3d at_rest = rest.vertices(Eigen::all, corner) * weights;
      touched.push_back({at_rest, (sample.point() - at_rest).norm()});
    }
  }
  return touched;
}

}  // namespace

std::vector<Vector3d> touched_places(const SurfaceMesh& rest, const SurfaceMesh& deformed,
                                     std::span<const Capsule> hand) {
  PALPABLE_EXPECT(rest.vertex_count() == deformed.vertex_count() &&
                      rest.triangle_count() == deformed.triangle_count() &&
                      rest.triangles == deformed.triangles,
                  "one skin, at rest and pressed");
  std::vector<TouchedSample> touched = samples_of(rest, deformed, hand);
  std::vector<Vector3d> places;
  while (!touched.empty()) {
    const auto farthest = std::max_element(
        touched.begin(), touched.end(),
        [](const TouchedSample& a, const TouchedSample& b) { return a.moved < b.moved; });
    const Vector3d place = farthest->at_rest;
    places.push_back(place);
    std::erase_if(touched, [&](const TouchedSample& sample) {
      return (sample.at_rest - place).norm() <= kTouchedPlace;
    });
  }
  return places;
}

}  // namespace palpable

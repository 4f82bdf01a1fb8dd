#include "palpable/desk/score/penetration.h"

#include "palpable/desk/score/deepest_sample.h"

namespace palpable {

double deepest_penetration(const SurfaceMesh& surface, std::span<const Capsule> capsules) {
  double deepest = 0;
  for (const Capsule& capsule : capsules) {
    DeepestSample sample(capsule, deepest);
    for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
      const auto corner = surface.triangles.col(t);
      sample.look_at(surface.vertices.col(corner[0]), surface.vertices.col(corner[1]),
                     surface.vertices.col(corner[2]));
    }
    deepest = sample.depth();
  }
  return deepest;
}

}  // namespace palpable

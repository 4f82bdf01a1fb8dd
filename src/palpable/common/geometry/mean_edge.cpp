#include "palpable/common/geometry/mean_edge.h"

#include "palpable/common/base/contract.h"

namespace palpable {

double mean_edge_length(const SurfaceMesh& surface) {
  PALPABLE_EXPECT(surface.triangle_count() > 0, "a surface has triangles");
  double sum = 0.0;  // each edge of a closed surface is counted twice
  for (const auto& t : surface.triangles.colwise()) {
    for (int k = 0; k < 3; ++k) {
      sum += (surface.vertices.col(t[k]) - surface.vertices.col(t[(k + 1) % 3])).norm();
    }
  }
  return sum / (3.0 * surface.triangle_count());
}

}  // namespace palpable

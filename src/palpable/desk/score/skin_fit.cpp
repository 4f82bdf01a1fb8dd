#include "palpable/desk/score/skin_fit.h"

#include "palpable/common/geometry/surface_distance.h"

#include <algorithm>
#include <cmath>

namespace palpable {
namespace {

double mean_distance(const SurfaceMesh& from, const SurfaceDistance& to) {
  const Eigen::VectorXd areas = vertex_areas(from);
  double sum = 0;
  for (int v = 0; v < from.vertex_count(); ++v) {
    sum += areas[v] * std::abs(to.nearest(from.vertices.col(v)).distance);
  }
  return sum / areas.sum();
}

}  // namespace

double skin_offset(const SurfaceMesh& a, const SurfaceMesh& b) {
  return std::max(mean_distance(a, SurfaceDistance(b)), mean_distance(b, SurfaceDistance(a)));
}

}  // namespace palpable

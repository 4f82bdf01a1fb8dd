#include "palpable/desk/script/desk_body.h"

#include "palpable/common/base/contract.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpable {

SurfacePoints sample_surface(const SurfaceMesh& surface, double spacing) {
  PALPABLE_EXPECT(spacing > 0.0, "the spacing is positive");
  const Eigen::Index N = surface.vertices.cols();
  std::vector<Eigen::Vector3d> points(N), inwards(N, Eigen::Vector3d::Zero());
  for (Eigen::Index v = 0; v < N; ++v) points[v] = surface.vertices.col(v);
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    const Eigen::Vector3i corner = surface.triangles.col(t);
    const Eigen::Vector3d a = surface.vertices.col(corner[0]);
    const Eigen::Vector3d ab = surface.vertices.col(corner[1]) - a;
    const Eigen::Vector3d ac = surface.vertices.col(corner[2]) - a;
    // The outward normal with twice the triangle's area as length, so that large triangles have
    // more weight in the normals at vertices.
    const Eigen::Vector3d area = ab.cross(ac);
    for (const int v : corner) inwards[v] -= area;
    const double longest = std::max({ab.norm(), ac.norm(), (ac - ab).norm()});
    const auto parts = static_cast<int>(std::ceil(longest / spacing));
    for (int i = 0; i <= parts; ++i)
      for (int j = 0; i + j <= parts; ++j) {
        if ((i == 0 && j == 0) || i == parts || j == parts) continue;  // the corners are vertices
        points.emplace_back(a + (ab * i + ac * j) / parts);
        inwards.emplace_back(-area);
      }
  }
  const auto count = static_cast<Eigen::Index>(points.size());
  SurfacePoints samples;
  samples.points.resize(3, count);
  samples.inwards.resize(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    samples.points.col(i) = points[i];
    samples.inwards.col(i) = inwards[i].normalized();
  }
  return samples;
}

SurfacePoints transformed(const SurfacePoints& points, const Rigid3& transform) {
  return {(transform.linear() * points.points).colwise() + transform.translation(),
          transform.linear() * points.inwards};
}

int nearest_site(const DeskBody& body, const Eigen::Vector3d& x_in_body) {
  int nearest = -1;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t s = 0; s < body.site_vertices.size(); ++s) {
    const double distance = (body.surface.vertices.col(body.site_vertices[s]) - x_in_body).norm();
    if (distance < least) {
      least = distance;
      nearest = static_cast<int>(s);
    }
  }
  return nearest;
}

}  // namespace palpable

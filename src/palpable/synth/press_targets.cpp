#include "palpable/synth/press_targets.h"

#include <Eigen/Geometry>

#include <algorithm>

namespace palpable {

using Eigen::Vector3d;

namespace {

Eigen::Matrix3Xf normals_of(const SurfaceMesh& surface) {
  Eigen::Matrix3Xf normals(3, surface.vertex_count());
  vertex_normals(surface.vertices.cast<float>(), surface.triangles, normals);
  return normals;
}

}  // namespace

Rigid3 turned_body(double yaw) {
  Rigid3 desk_from_body = Rigid3::Identity();
  desk_from_body.linear() = Eigen::AngleAxisd(yaw, Vector3d::UnitZ()).toRotationMatrix();
  return desk_from_body;
}

std::vector<PressTarget> site_targets(const DeskBody& body, const Rigid3& desk_from_body) {
  const Eigen::Matrix3Xf normals = normals_of(body.surface);
  const Eigen::Matrix3d R = desk_from_body.linear();
  std::vector<PressTarget> targets;
  for (std::size_t s = 0; s < body.site_vertices.size(); ++s) {
    const int v = body.site_vertices[s];
    targets.push_back({desk_from_body * body.surface.vertices.col(v),
                       R * body.directions.col(static_cast<Eigen::Index>(s)),
                       R * normals.col(v).cast<double>(), static_cast<int>(s), false});
  }
  return targets;
}

std::vector<PressTarget> between_targets(const DeskBody& body, const Rigid3& desk_from_body) {
  const Eigen::Matrix3Xf normals = normals_of(body.surface);
  const Eigen::Matrix3d R = desk_from_body.linear();
  const auto S = body.site_vertices.size();
  const auto place = [&](std::size_t s) -> Vector3d {
    return body.surface.vertices.col(body.site_vertices[s]);
  };
  std::vector<PressTarget> targets;
  for (std::size_t s = 0; s < S; ++s) {
    // Its nearest neighbour among the later sites: each pair once.
    std::size_t other = S;
    for (std::size_t o = s + 1; o < S; ++o)
      if (other == S || (place(o) - place(s)).norm() < (place(other) - place(s)).norm()) other = o;
    if (other == S) continue;
    const double apart = (place(other) - place(s)).norm();
    if (apart < 0.015 || apart > 0.060) continue;
    const Vector3d middle = 0.5 * (place(s) + place(other));
    Eigen::Index v = 0;
    (body.surface.vertices.colwise() - middle).colwise().squaredNorm().minCoeff(&v);
    const Vector3d x = body.surface.vertices.col(v);
    if (std::min((x - place(s)).norm(), (x - place(other)).norm()) < 0.006) continue;
    const Vector3d sum = body.directions.col(static_cast<Eigen::Index>(s)) +
                         body.directions.col(static_cast<Eigen::Index>(other));
    if (sum.norm() < 0.5) continue;  // they press against each other
    targets.push_back({desk_from_body * x, R * sum.normalized(), R * normals.col(v).cast<double>(),
                       nearest_site(body, x), true});
  }
  return targets;
}

}  // namespace palpable

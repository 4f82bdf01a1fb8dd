#include "palpable/desk/script/press_targets.h"

#include "palpable/common/geometry/rigid.h"
#include "palpable/desk/script/camera_motions.h"

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
    // The nearest neighbour among the later sites, so that each pair occurs once.
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
    if (sum.norm() < 0.5) continue;  // the two directions are nearly opposite
    targets.push_back({desk_from_body * x, R * sum.normalized(), R * normals.col(v).cast<double>(),
                       nearest_site(body, x), true});
  }
  return targets;
}

std::vector<PressTarget> skin_targets(const DeskBody& body, const Rigid3& desk_from_body, int most,
                                      double lean) {
  const Eigen::Matrix3Xf normals = normals_of(body.surface);
  const Eigen::Index V = body.surface.vertex_count();
  const Eigen::Index step = std::max<Eigen::Index>(1, V / most);
  std::vector<PressTarget> targets;
  for (Eigen::Index v = 0; v < V; v += step) {
    const Vector3d x = body.surface.vertices.col(v);
    const Vector3d normal = desk_from_body.linear() * normals.col(v).cast<double>();
    targets.push_back({desk_from_body * x, (lean * -Vector3d::UnitX() - normal).normalized(),
                       normal, nearest_site(body, x), true});
  }
  return targets;
}

PressSearch mirror_image(const PressSearch& search) {
  const Vector3d flip(-1, 1, 1);
  return {flip.asDiagonal() * search.points(), flip.asDiagonal() * search.eye()};
}

SurfacePoints mirror_image(const SurfacePoints& surface) {
  const Vector3d flip(-1, 1, 1);
  return {flip.asDiagonal() * surface.points, flip.asDiagonal() * surface.inwards};
}

std::vector<PressTarget> mirror_image(std::vector<PressTarget> targets) {
  for (PressTarget& t : targets)
    for (Vector3d* v : {&t.x, &t.direction, &t.normal}) v->x() = -v->x();
  return targets;
}

std::vector<double> yaws_to_press(const DeskBody& body, const PressRules& rules, std::size_t sites,
                                  bool two_hands) {
  const auto value_of = [&](const PressSearch& search, const std::vector<PressTarget>& targets) {
    const std::vector<RankedTarget> list = search.ranked(targets, rules);
    double value = 0.0;
    for (std::size_t s = 0; s < std::min(sites, list.size()); ++s) value += list[s].score;
    return value;
  };
  struct Yaw {
    double value, angle;
  };
  std::vector<Yaw> yaws;
  for (int i = 0; i < 36; ++i) {
    const double angle = 10.0 * i * kDegree;
    const Rigid3 turned = turned_body(angle);
    const PressSearch search(turned.linear() * body.surface.vertices, first_eye());
    const std::vector<PressTarget> targets = site_targets(body, turned);
    double value = value_of(search, targets);
    if (two_hands) value = std::min(value, value_of(mirror_image(search), mirror_image(targets)));
    if (value > 0.0) yaws.push_back({value, angle});
  }
  std::stable_sort(yaws.begin(), yaws.end(),
                   [](const Yaw& a, const Yaw& b) { return a.value > b.value; });
  std::vector<double> angles;
  for (const Yaw& yaw : yaws) angles.push_back(yaw.angle);
  return angles;
}

}  // namespace palpable

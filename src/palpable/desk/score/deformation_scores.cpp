#include "palpable/desk/score/deformation_scores.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/geometry/surface_distance.h"
#include "palpable/desk/score/skin_scores.h"

#include <algorithm>
#include <cmath>

namespace palpable {

using Eigen::Vector3d;

namespace {

// m; a skin is touched where a sample of it is this near to the obstacle. If a pencil's tip
// (radius 1.2 mm) lies on the skin, the nearest of samples 2 mm apart is at most 0.46 mm from the
// tip; the penetration between the contact points of a solver is smaller than this.
constexpr double kTouches = 0.0005;

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

double overpress_at(const Eigen::Matrix3Xd& rest, const Eigen::Matrix3Xd& truth,
                    const Eigen::Matrix3Xd& found, const Eigen::Vector3d& touched) {
  const Eigen::RowVectorXd away = (rest.colwise() - touched).colwise().norm();
  const double reach = std::max(kTouchedPlace, away.minCoeff());
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (Eigen::Index v = 0; v < rest.cols(); ++v) {
    if (away[v] <= reach) sum += truth.col(v);
  }
  double most = 0;
  for (Eigen::Index v = 0; v < rest.cols(); ++v) {
    if (away[v] > reach) continue;
    const Eigen::Vector3d off = found.col(v) - truth.col(v);
    // If the true skin does not move, a displacement in any direction is too large.
    most = std::max(most, sum.norm() > 0 ? off.dot(sum.normalized()) : off.norm());
  }
  return most;
}

}  // namespace

DisplacementError displacement_error(const Eigen::Matrix3Xd& truth, const Eigen::Matrix3Xd& found,
                                     const Eigen::VectorXd& areas) {
  PALPABLE_EXPECT(truth.cols() == found.cols() && truth.cols() == areas.size() && areas.size() > 0,
                  "both displacements and the areas are of one skin");
  const Eigen::Matrix3Xd off = found - truth;
  const double wrong = off.colwise().squaredNorm().dot(areas);
  const double whole = truth.colwise().squaredNorm().dot(areas);
  DisplacementError error;
  if (wrong > 0) error.relative = std::sqrt(wrong / whole);
  error.worst = off.colwise().norm().maxCoeff();
  return error;
}

double von_mises_error(const Eigen::VectorXd& truth, const Eigen::VectorXd& found) {
  PALPABLE_EXPECT(truth.size() == found.size() && truth.size() > 0,
                  "both stresses are of one skin");
  const double worst = (found - truth).cwiseAbs().maxCoeff();
  return worst == 0 ? 0 : worst / truth.maxCoeff();
}

double force_error(const Eigen::Vector3d& truth, std::span<const Eigen::Vector3d> felt) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& force : felt) sum += force;
  const double off = (sum - truth).norm();
  return off == 0 ? 0 : off / truth.norm();
}

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

double overpress(const Eigen::Matrix3Xd& rest, const Eigen::Matrix3Xd& truth,
                 const Eigen::Matrix3Xd& found, std::span<const Eigen::Vector3d> touched) {
  PALPABLE_EXPECT(rest.cols() == truth.cols() && rest.cols() == found.cols() && rest.cols() > 0,
                  "both displacements are of one skin");
  PALPABLE_EXPECT(!touched.empty(), "a touch is somewhere");
  double most = 0;
  for (const Eigen::Vector3d& place : touched) {
    most = std::max(most, overpress_at(rest, truth, found, place));
  }
  return most;
}

SkinProjection::SkinProjection(const SurfaceMesh& from, const Eigen::Matrix3Xd& to)
    : from_count_(from.vertices.cols()) {
  PALPABLE_EXPECT(from.triangle_count() > 0, "a skin has triangles");
  corners_.resize(3, to.cols());
  weights_.resize(3, to.cols());
  const SurfaceDistance skin(from);
  for (Eigen::Index v = 0; v < to.cols(); ++v) {
    const NearestOnSurface nearest = skin.nearest(to.col(v));
    corners_.col(v) = from.triangles.col(nearest.triangle);
    weights_.col(v) = nearest.weights;
  }
}

Eigen::Matrix3Xd SkinProjection::vectors(const Eigen::Matrix3Xd& field) const {
  PALPABLE_EXPECT(field.cols() == from_count_, "one vector per vertex of the skin");
  Eigen::Matrix3Xd projected(3, corners_.cols());
  for (Eigen::Index v = 0; v < corners_.cols(); ++v) {
    projected.col(v) = field(Eigen::all, corners_.col(v)) * weights_.col(v);
  }
  return projected;
}

Eigen::VectorXd SkinProjection::numbers(const Eigen::VectorXd& field) const {
  PALPABLE_EXPECT(field.size() == from_count_, "one number per vertex of the skin");
  Eigen::VectorXd projected(corners_.cols());
  for (Eigen::Index v = 0; v < corners_.cols(); ++v) {
    projected[v] = field(corners_.col(v)).dot(weights_.col(v));
  }
  return projected;
}

}  // namespace palpable

#include "palpable/common/contact/contact_pressure.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/geometry/surface_mesh.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace palpable {
namespace {

using Eigen::Matrix3Xf;
using Eigen::Vector3f;

// Reach of a force, ratio to the larger of both spacings. On a square grid the diagonal neighbour
// lies at 1.41. Smaller: the pressure shows single points; larger: its edges are blurred.
constexpr float kReach = 1.5f;
// Smallest cosine between a force and the inward normal of a vertex that has a share of it: the
// other side of a thin part has none.
constexpr float kFaces = 0.2f;

std::size_t index(Eigen::Index i) { return static_cast<std::size_t>(i); }

}  // namespace

ContactPressure::ContactPressure(const SurfaceMesh& skin)
    : triangles_(skin.triangles), usual_edge_(static_cast<float>(mean_edge_length(skin))) {
  const auto V = index(skin.vertices.cols());
  near_.reserve(V);
  is_near_.resize(V);
  areas_.resize(V);
  weights_.resize(V);
}

float ContactPressure::reach(float spacing) const {
  return kReach * std::max(spacing, usual_edge_);
}

// Finds the vertices that may have a share of a force, and their areas.
void ContactPressure::find_near(const TouchPatches& pressed, const Matrix3Xf& vertices) {
  Eigen::AlignedBox3f box;
  for (std::size_t i = 0; i < pressed.points().size(); ++i) {
    const Vector3f r = Vector3f::Constant(reach(pressed.spacing(i)));
    box.extend(pressed.points()[i].place - r);
    box.extend(pressed.points()[i].place + r);
  }
  near_.clear();
  for (int v = 0; v < vertices.cols(); ++v) {
    is_near_[index(v)] = box.contains(vertices.col(v)) ? 1 : 0;
    areas_[index(v)] = 0;
    if (is_near_[index(v)] != 0) near_.push_back(v);
  }
  for (Eigen::Index t = 0; t < triangles_.cols(); ++t) {
    const int a = triangles_(0, t), b = triangles_(1, t), c = triangles_(2, t);
    if (is_near_[index(a)] + is_near_[index(b)] + is_near_[index(c)] == 0) continue;
    const Vector3f ab = vertices.col(b) - vertices.col(a), ac = vertices.col(c) - vertices.col(a);
    const float third = ab.cross(ac).norm() / 6;
    for (const int v : {a, b, c}) areas_[index(v)] += third;
  }
}

void ContactPressure::spread(const TouchPatches& pressed, const Matrix3Xf& vertices,
                             const Matrix3Xf& normals, std::vector<float>& pressure) {
  PALPABLE_EXPECT(index(vertices.cols()) == areas_.size() && normals.cols() == vertices.cols(),
                  "the vertices are the skin's");
  pressure.assign(areas_.size(), 0.0f);
  if (pressed.points().empty()) return;
  find_near(pressed, vertices);
  for (std::size_t i = 0; i < pressed.points().size(); ++i) {
    const PressedPoint& point = pressed.points()[i];
    const Vector3f pressing = point.force - point.friction;
    const float force = pressing.norm(), r = reach(pressed.spacing(i));
    if (!(force > 0)) continue;
    const Vector3f direction = pressing / force;
    float sum = 0, nearest = 0;
    int nearest_vertex = -1;
    for (std::size_t k = 0; k < near_.size(); ++k) {
      const int v = near_[k];
      const float squared = (vertices.col(v) - point.place).squaredNorm();
      if (nearest_vertex < 0 || squared < nearest) nearest = squared, nearest_vertex = v;
      const bool has_share = squared < r * r && -direction.dot(normals.col(v)) > kFaces;
      weights_[k] = has_share ? areas_[index(v)] * (1 - squared / (r * r)) : 0;
      sum += weights_[k];
    }
    if (sum > 0) {
      for (std::size_t k = 0; k < near_.size(); ++k) {
        if (!(weights_[k] > 0)) continue;
        pressure[index(near_[k])] += force * weights_[k] / (sum * areas_[index(near_[k])]);
      }
    } else if (nearest_vertex >= 0 && areas_[index(nearest_vertex)] > 0) {
      // No vertex faces the force: on a ridge, or in a triangle much larger than the others.
      pressure[index(nearest_vertex)] += force / areas_[index(nearest_vertex)];
    }
  }
}

}  // namespace palpable

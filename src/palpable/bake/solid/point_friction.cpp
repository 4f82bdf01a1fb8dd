#include "palpable/bake/solid/point_friction.h"

#include <algorithm>
#include <cmath>

namespace palpable {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

Vector3d in_plane(const Vector3d& v, const Vector3d& normal) { return v - normal.dot(v) * normal; }

}  // namespace

double evaluate_friction(const Friction& law, double penalty, double pressing,
                         const Vector3d& apart, bool glued, PointFriction& point) {
  point.limit = point.anchored ? law.coefficient * pressing : 0.0;
  point.stiffness = law.stiffness * penalty;
  point.slide = in_plane(apart, point.normal);
  point.slips = false;
  if (point.limit == 0.0) {
    point.force.setZero();
    return 0.0;
  }
  const Vector3d trial = -point.stiffness * point.slide;  // q
  const double most = point.limit, size = trial.norm();
  point.slips = !glued && size > most;
  point.force = point.slips ? Vector3d(most / size * trial) : trial;
  const double beyond = point.slips ? size - most : 0.0;
  return 0.5 * (size * size - beyond * beyond) / point.stiffness;
}

Matrix3d friction_stiffness(const PointFriction& point) {
  if (point.limit == 0.0) return Matrix3d::Zero();
  const Matrix3d across = Matrix3d::Identity() - point.normal * point.normal.transpose();
  if (!point.slips) return point.stiffness * across;
  const Vector3d trial = -point.stiffness * point.slide;
  const double size = trial.norm();
  const Vector3d along = trial / size;
  return point.stiffness * point.limit / size * (across - along * along.transpose());
}

double update_cone(const Friction& law, double penalty, double before, double now,
                   const Vector3d& normal, PointFriction& point) {
  point.normal = normal;
  // Far inside the cone its size does not matter.
  if (2.0 * point.force.norm() <= point.limit) return 0.0;
  return law.coefficient * std::abs(now - before) / (law.stiffness * penalty);
}

Vector3d elastic_slip(const PointFriction& point) { return -point.force / point.stiffness; }

double dissipated(const PointFriction& point) {
  return point.slips ? -point.force.dot(point.slide - elastic_slip(point)) : 0.0;
}

double time_of_contact(double before, double without) {
  if (before <= 0.0) return 0.0;
  return without < 0.0 ? before / (before - without) : 1.0;
}

}  // namespace palpable

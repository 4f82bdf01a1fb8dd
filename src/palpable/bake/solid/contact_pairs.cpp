#include "palpable/bake/solid/contact_pairs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace palpable {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

auto contact_key(const ContactPair& pair) { return std::tuple(pair.point, pair.part); }

std::vector<int> parts_near(const ObstacleGaps& gaps, const Matrix3Xd& positions, double margin) {
  const Eigen::AlignedBox3d box(positions.rowwise().minCoeff() - Vector3d::Constant(margin),
                                positions.rowwise().maxCoeff() + Vector3d::Constant(margin));
  std::vector<int> parts;
  for (int part = 0; part < gaps.part_count(); ++part) {
    if (gaps.may_reach(part, box)) parts.push_back(part);
  }
  return parts;
}

bool has_force(const ContactPair& pair) {
  return pair.force != 0.0 || pair.friction != Vector3d::Zero();
}

bool comes_before(const ContactPair& a, const ContactPair& b) {
  return contact_key(a) < contact_key(b);
}

}  // namespace

ContactPairs::ContactPairs(const TetAssembly& assembly, const Boundary& boundary,
                           const ContactPoints& points, const VectorXd& penalties,
                           const Friction& friction)
    : boundary_(boundary),
      points_(points),
      penalties_(penalties),
      friction_(friction),
      free_of_node_(assembly.node_count(), -1) {
  const std::vector<int>& free = assembly.free_nodes();
  for (std::size_t m = 0; m < free.size(); ++m) free_of_node_[free[m]] = static_cast<int>(m);
  assembly.gather(Matrix3Xd::Ones(3, assembly.node_count()), mask_);
}

bool ContactPairs::has(int point, int part) const {
  return std::binary_search(pairs_.begin(), pairs_.end(),
                            ContactPair{.point = point, .part = part, .gap = {}}, comes_before);
}

int ContactPairs::find(const ObstacleGaps& gaps, const Matrix3Xd& positions, double margin) {
  std::vector<ContactPair> fresh;
  const SurfaceMesh& skin = boundary_.surface;
  const std::vector<int> parts = parts_near(gaps, positions, margin);
  for (int t = 0; t < skin.triangle_count(); ++t) {
    const auto corner = [&](int k) -> Vector3d {
      return positions.col(boundary_.node_of_vertex[skin.triangles(k, t)]);
    };
    const Vector3d centre = (corner(0) + corner(1) + corner(2)) / 3.0;
    double radius = 0.0;
    for (int k = 0; k < 3; ++k) radius = std::max(radius, (corner(k) - centre).norm());
    for (const int part : parts) {
      if (gaps.distance(part, centre) > radius + margin) continue;
      for (int i = points_.first[t]; i < points_.first[t + 1]; ++i) {
        const int point = points_.of_triangle[i];
        const Vector3d x = position_of(points_.points[point], positions);
        const double distance = gaps.distance(part, x);
        if (distance > margin || has(point, part)) continue;
        fresh.push_back({.point = point, .part = part, .penalty = penalties_[point], .gap = {}});
        fresh.back().gap.distance = distance;
      }
    }
  }
  // A point on an edge belongs to several triangles.
  std::sort(fresh.begin(), fresh.end(), comes_before);
  const auto same = [](const ContactPair& a, const ContactPair& b) {
    return contact_key(a) == contact_key(b);
  };
  fresh.erase(std::unique(fresh.begin(), fresh.end(), same), fresh.end());
  const auto touches = [](const ContactPair& pair) { return pair.gap.distance < 0.0; };
  const auto touching = std::count_if(fresh.begin(), fresh.end(), touches);

  std::erase_if(pairs_, [&](const ContactPair& pair) {
    const Vector3d x = position_of(points_.points[pair.point], positions);
    return pair.multiplier == 0.0 && gaps.distance(pair.part, x) > 2.0 * margin;
  });
  pairs_.insert(pairs_.end(), fresh.begin(), fresh.end());
  std::sort(pairs_.begin(), pairs_.end(), comes_before);
  return static_cast<int>(touching);
}

void ContactPairs::reassign_parts(const ObstacleGaps& gaps, const Matrix3Xd& positions) {
  const int parts = gaps.part_count();
  if (parts == std::exchange(parts_, parts)) return;
  std::erase_if(pairs_,
                [&](const ContactPair& pair) { return pair.multiplier == 0.0 || parts == 0; });
  for (ContactPair& pair : pairs_) {
    const Vector3d x = position_of(points_.points[pair.point], positions);
    double least = std::numeric_limits<double>::infinity();
    for (int part = 0; part < parts; ++part) {
      const double distance = gaps.distance(part, x);
      if (distance >= least) continue;
      least = distance;
      pair.part = part;
    }
  }
  std::sort(pairs_.begin(), pairs_.end(), comes_before);
  // Two pairs of one point may have been assigned to the same part.
  const auto same = [](const ContactPair& a, const ContactPair& b) {
    return contact_key(a) == contact_key(b);
  };
  pairs_.erase(std::unique(pairs_.begin(), pairs_.end(), same), pairs_.end());
}

void ContactPairs::begin_step(const ObstacleGaps& gaps, const Obstacle& before,
                              const Matrix3Xd& positions_before) {
  // Where the number of parts has changed, their motion during the step is unknown, and there is no
  // friction.
  const bool same = before.part_count() == gaps.part_count();
  for (ContactPair& pair : pairs_) {
    const Vector3d x = position_of(points_.points[pair.point], positions_before);
    pair.has_friction = same && pair.multiplier > 0.0;
    pair.stick_position = pair.has_friction ? carried(before, gaps.obstacle(), pair.part, x) : x;
    pair.slide_normal = pair.gap.normal;
    pair.slide = pair.friction = Vector3d::Zero();
  }
}

double ContactPairs::largest_friction(const ContactPair& pair) const {
  return pair.has_friction ? friction_.coefficient * pair.multiplier : 0.0;
}

// Sets slide and friction of a pair whose point is at x. @returns its term of D, J
double ContactPairs::evaluate_friction(const Vector3d& x, ContactPair& pair) const {
  const double most = largest_friction(pair), e = friction_.sticking;
  const Vector3d moved = x - pair.stick_position;
  pair.slide = moved - pair.slide_normal.dot(moved) * pair.slide_normal;
  const double way = pair.slide.norm();
  pair.friction = -most / std::max(way, e) * pair.slide;
  return most * (way < e ? 0.5 * way * way / e : way - 0.5 * e);
}

// Minus the derivative of a pair's force by the position of its point, without the obstacle's
// curvature.
Matrix3d ContactPairs::stiffness(const ContactPair& pair) const {
  const Vector3d n = pair.gap.normal;
  Matrix3d K =
      pair.force == 0.0 ? Matrix3d(Matrix3d::Zero()) : Matrix3d(pair.penalty * n * n.transpose());
  const double most = largest_friction(pair);
  if (most == 0.0) return K;
  const double way = pair.slide.norm();
  const Matrix3d across = Matrix3d::Identity() - pair.slide_normal * pair.slide_normal.transpose();
  if (way < friction_.sticking) return K + most / friction_.sticking * across;
  const Vector3d along = pair.slide / way;
  return K + most / way * (across - along * along.transpose());
}

double ContactPairs::evaluate(const ObstacleGaps& gaps, const Matrix3Xd& positions, bool glued) {
  double energy = 0.0;
  for (ContactPair& pair : pairs_) {
    const Vector3d x = position_of(points_.points[pair.point], positions);
    pair.gap = gaps.gap(pair.part, x);
    pair.force = pair.multiplier - pair.penalty * pair.gap.distance;
    if (!(glued && pair.multiplier > 0.0)) pair.force = std::max(0.0, pair.force);
    energy += 0.5 / pair.penalty * (pair.force + pair.multiplier) * (pair.force - pair.multiplier);
    if (pair.has_friction) energy += evaluate_friction(x, pair);
  }
  return energy;
}

void ContactPairs::add_forces(Matrix3Xd& force) const {
  for (const ContactPair& pair : pairs_) {
    if (!has_force(pair)) continue;
    const ContactPoint& point = points_.points[pair.point];
    for (int k = 0; k < point.count; ++k) {
      force.col(point.nodes[k]) += point.shape[k] * pair.whole_force();
    }
  }
}

void ContactPairs::add_product(const VectorXd& x, bool with_curvature, VectorXd& y) const {
  for (const ContactPair& pair : pairs_) {
    if (!has_force(pair)) continue;
    const ContactPoint& point = points_.points[pair.point];
    Vector3d moves = Vector3d::Zero();
    for (int k = 0; k < point.count; ++k) {
      const int free = free_of_node_[point.nodes[k]];
      if (free >= 0) moves += point.shape[k] * x.segment<3>(3 * free);
    }
    Vector3d pull = stiffness(pair) * moves;
    if (with_curvature) pull -= pair.force * (pair.gap.curvature * moves);
    for (int k = 0; k < point.count; ++k) {
      const int free = free_of_node_[point.nodes[k]];
      if (free < 0) continue;
      y.segment<3>(3 * free) += point.shape[k] * pull.cwiseProduct(mask_.segment<3>(3 * free));
    }
  }
}

void ContactPairs::add_tangent(BlockMatrix& K) const {
  for (const ContactPair& pair : pairs_) {
    if (!has_force(pair)) continue;
    const ContactPoint& point = points_.points[pair.point];
    const Matrix3d stiff = stiffness(pair);
    for (int i = 0; i < point.count; ++i) {
      const int row = free_of_node_[point.nodes[i]];
      if (row < 0) continue;
      for (int j = 0; j < point.count; ++j) {
        const int column = free_of_node_[point.nodes[j]];
        if (column < 0) continue;
        // Nodes of one face share a tetrahedron, so the block is there.
        K.block(K.pattern().find(row, column)) += point.shape[i] * point.shape[j] *
                                                  mask_.segment<3>(3 * row).asDiagonal() * stiff *
                                                  mask_.segment<3>(3 * column).asDiagonal();
      }
    }
  }
}

double ContactPairs::update_multipliers() {
  double largest = 0.0;
  for (ContactPair& pair : pairs_) {
    largest = std::max(largest, std::abs(pair.force - pair.multiplier) / pair.penalty);
    pair.multiplier = pair.force;
    pair.slide_normal = pair.gap.normal;
  }
  return largest;
}

}  // namespace palpable

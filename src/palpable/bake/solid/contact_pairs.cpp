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

// The number that a part of `now` had in `before`. Where the obstacle has another number of parts
// than before, this is the part whose motion would take x least far, and only if no other part of
// `now` fits it better: parts move continuously, so a part is recognised by that.
std::optional<int> old_number(const Obstacle& before, const Obstacle& now, int part,
                              const Vector3d& x) {
  if (has_same_parts(before, now)) return part;
  const auto kind = part_kind(now, part);
  const auto way = [&](int old_part, int new_part) {
    return (carried(before, old_part, now, new_part, x) - x).squaredNorm();
  };
  std::optional<int> found;
  for (int other = 0; other < before.part_count(); ++other) {
    if (part_kind(before, other) != kind) continue;
    if (!found || way(other, part) < way(*found, part)) found = other;
  }
  if (!found) return std::nullopt;
  for (int other = 0; other < now.part_count(); ++other) {
    if (part_kind(now, other) == kind && way(*found, other) < way(*found, part)) {
      return std::nullopt;
    }
  }
  return found;
}

bool has_force(const ContactPair& pair) { return pair.force != 0.0 || pair.friction.limit != 0.0; }

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
  for (std::size_t i = 0; i < points.points.size(); ++i) {
    if (is_held(points.points[i])) held_points_.push_back(static_cast<int>(i));
  }
}

bool ContactPairs::is_held(const ContactPoint& point) const {
  return std::all_of(point.nodes.begin(), point.nodes.begin() + point.count,
                     [&](int node) { return free_of_node_[node] < 0; });
}

double ContactPairs::held_entry(const ObstacleGaps& gaps, const Matrix3Xd& positions) const {
  double entry = 0.0;
  const std::vector<int> parts = parts_near(gaps, positions, 0.0);
  for (const int point : held_points_) {
    const Vector3d x = position_of(points_.points[point], positions);
    for (const int part : parts) entry = std::max(entry, -gaps.distance(part, x));
  }
  return entry;
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
        if (distance > margin || is_held(points_.points[point]) || has(point, part)) continue;
        fresh.push_back({.point = point,
                         .part = part,
                         .penalty = penalties_[point],
                         .left_out = leaves_out_new_,
                         .gap = {}});
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

void ContactPairs::reassign_parts(const ObstacleGaps& gaps, const Obstacle& before,
                                  const Matrix3Xd& positions) {
  if (has_same_parts(before, gaps.obstacle())) return;
  const int parts = gaps.part_count();
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

void ContactPairs::set_friction(double coefficient, const Matrix3Xd& positions) {
  const bool had_none = friction_.coefficient == 0.0;
  friction_.coefficient = coefficient;
  if (!had_none && coefficient > 0.0) return;
  for (ContactPair& pair : pairs_) {
    pair.friction = {};
    pair.friction.anchored = coefficient > 0.0 && pair.multiplier > 0.0;
    pair.anchor = position_of(points_.points[pair.point], positions);
  }
}

void ContactPairs::begin_step(const ObstacleGaps& gaps, const Obstacle& before,
                              const Matrix3Xd& positions_before) {
  before_.emplace(before);
  positions_before_ = predicted_ = positions_before;
  for (ContactPair& pair : pairs_) {
    if (!pair.friction.anchored || pair.multiplier == 0.0) {
      pair.friction = {};
      continue;
    }
    const Vector3d x = position_of(points_.points[pair.point], positions_before);
    const std::optional<int> part = old_number(before, gaps.obstacle(), pair.part, x);
    if (!part) {
      pair.friction = {};
      continue;
    }
    pair.anchor = carried(before, *part, gaps.obstacle(), pair.part, pair.anchor);
    pair.friction.normal = gaps.gap(pair.part, pair.anchor).normal;
  }
}

void ContactPairs::leave_out_new(bool leave_out) {
  leaves_out_new_ = leave_out;
  for (ContactPair& pair : pairs_) pair.left_out = leave_out && pair.multiplier == 0.0;
}

// The place of the obstacle, at its pose at the end of the step, that a point touched first, x if
// it would not have been touched without the forces of the step. The point came from its position
// at the beginning of the step in a straight line, towards where it would be without its own force.
Vector3d ContactPairs::place_of_contact(const ObstacleGaps& gaps, const ContactPair& pair,
                                        const Vector3d& x) const {
  const Obstacle& before = before_->obstacle();
  const ContactPoint& point = points_.points[pair.point];
  const Vector3d from = position_of(point, positions_before_);
  const std::optional<int> part = old_number(before, gaps.obstacle(), pair.part, from);
  if (!part) return x;  // the motion of the part during the step is unknown
  const Vector3d without = position_of(point, predicted_);
  const double time =
      time_of_contact(before_->distance(*part, from), gaps.distance(pair.part, without));
  if (time == 1.0) return x;
  const Vector3d place = from + time * (without - from);
  return place + (1.0 - time) * (carried(before, *part, gaps.obstacle(), pair.part, place) - place);
}

double ContactPairs::update_friction(const ObstacleGaps& gaps, const Matrix3Xd& positions) {
  double largest = 0.0;
  for (ContactPair& pair : pairs_) {
    largest = std::max(largest, update_cone(friction_, pair.penalty, pair.multiplier, pair.force,
                                            pair.gap.normal, pair.friction));
    if (pair.friction.anchored || pair.force == 0.0) continue;
    pair.friction.anchored = true;
    pair.anchor = place_of_contact(gaps, pair, position_of(points_.points[pair.point], positions));
  }
  return largest;
}

double ContactPairs::end_step(const Matrix3Xd& positions) {
  double sum = 0.0;
  for (ContactPair& pair : pairs_) {
    sum += dissipated(pair.friction);
    if (pair.multiplier == 0.0) {
      pair.friction.anchored = false;
    } else if (pair.friction.slips) {
      const Vector3d x = position_of(points_.points[pair.point], positions);
      pair.anchor = x - elastic_slip(pair.friction);
    }
  }
  return sum;
}

// Minus the derivative of a pair's force by the position of its point, without the obstacle's
// curvature.
Matrix3d ContactPairs::stiffness(const ContactPair& pair) const {
  const Vector3d n = pair.gap.normal;
  Matrix3d K =
      pair.force == 0.0 ? Matrix3d(Matrix3d::Zero()) : Matrix3d(pair.penalty * n * n.transpose());
  if (pair.friction.limit == 0.0) return K;
  return K + friction_stiffness(pair.friction);
}

double ContactPairs::evaluate(const ObstacleGaps& gaps, const Matrix3Xd& positions, bool glued) {
  double energy = 0.0;
  for (ContactPair& pair : pairs_) {
    const Vector3d x = position_of(points_.points[pair.point], positions);
    pair.gap = gaps.gap(pair.part, x);
    if (pair.left_out) {
      pair.force = 0.0;
      continue;
    }
    pair.force = pair.multiplier - pair.penalty * pair.gap.distance;
    if (!(glued && pair.multiplier > 0.0)) pair.force = std::max(0.0, pair.force);
    energy += 0.5 / pair.penalty * (pair.force + pair.multiplier) * (pair.force - pair.multiplier);
    if (!pair.friction.anchored) continue;
    energy += evaluate_friction(friction_, pair.penalty, pair.multiplier, x - pair.anchor, glued,
                                pair.friction);
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
  }
  return largest;
}

}  // namespace palpable

/// @file
/// Cushions (elastic_cushion.h) on top of each other, solved together: with tables, with modes, or
/// as rigid obstacles.
#pragma once

#include "palpable/common/contact/capsule_obstacles.h"
#include "palpable/common/contact/contact_solver.h"
#include "palpable/common/contact/prescribed_skin.h"
#include "palpable/common/response/modal_body.h"
#include "palpable/common/response/tables_body.h"
#include "tests/support/elastic_cushion.h"

#include <Eigen/Core>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <vector>

namespace palpable::test {

inline constexpr double kFinger = 0.008;  // m, radius
inline constexpr double kApart = 0.0002;  // m, gap between cushions
inline constexpr double kTop = ElasticCushion::kHigh;

// A finger that points down and penetrates the top by `depth`.
inline CapsuleObstacles finger(double depth) {
  const Eigen::Vector3d tip(0.001, -0.002, kTop - depth + kFinger);
  const Capsule capsule{tip, tip + Eigen::Vector3d(0, 0, 0.04), kFinger, kFinger};
  CapsuleObstacles obstacles;
  obstacles.set({&capsule, 1});
  return obstacles;
}

enum class Kind { kTables, kModes, kFixed };

// One cushion of a stack; each is rotated differently.
struct Layer {
  ElasticCushion cushion;
  std::optional<ReducedBody> in_modes;
  ModalTables modal_tables;
  std::unique_ptr<TablesBody> tables;
  std::unique_ptr<ModalBody> modes;
  std::unique_ptr<PrescribedSkin> fixed;
  TouchState state;
  ModalState modal_state;

  // @param leading  number of eigenvectors of the compliance
  Layer(Kind kind, int leading, const TouchSettings& settings) : cushion(leading) {
    if (kind == Kind::kTables) {
      tables = std::make_unique<TablesBody>(cushion.skin, cushion.fixed, cushion.tables, settings);
      tables->use(state);
    } else if (kind == Kind::kModes) {
      in_modes.emplace(cushion.in_modes());
      modal_tables.half_space = 4e-8;  // 1/Pa: 1 % of the compliance of a point, as in the tables
      modal_tables.point_spacing = cushion.tables.point_spacing;
      ModalSettings as_tables;
      as_tables.entry = settings.entry;
      as_tables.friction = settings.friction;
      modes =
          std::make_unique<ModalBody>(ModalMember{&*in_modes, &modal_tables}, nullptr, as_tables);
      modes->use(modal_state);
    } else {
      fixed = std::make_unique<PrescribedSkin>(cushion.skin);
    }
  }
  [[nodiscard]] ContactBody& body() const {
    if (tables) return *tables;
    if (modes) return *modes;
    return *fixed;
  }
  [[nodiscard]] Eigen::Matrix3Xf skin() const {
    if (modes) return modes->place(modal_state);
    Eigen::Matrix3Xf x = cushion.skin.vertices.cast<float>();
    if (state.u.cols() > 0) x += state.u;
    return x;
  }
  [[nodiscard]] double largest_move() const {
    return static_cast<double>(
        (skin() - cushion.skin.vertices.cast<float>()).colwise().norm().maxCoeff());
  }
};

struct Stack {
  std::vector<std::unique_ptr<Layer>> layers;  // the first is under the finger
  std::vector<ContactSolver::Member> members;
  std::unique_ptr<ContactSolver> solver;
  ContactReport report;

  explicit Stack(const std::vector<Kind>& kinds, double apart = kApart, int leading = 0,
                 const TouchSettings& settings = {}) {
    for (std::size_t k = 0; k < kinds.size(); ++k) {
      layers.push_back(std::make_unique<Layer>(kinds[k], leading, settings));
      Rigid3 pose = Rigid3::Identity();
      pose.linear() = (Eigen::AngleAxisd(0.7 * static_cast<double>(k), Eigen::Vector3d::UnitZ()) *
                       Eigen::AngleAxisd(static_cast<double>(k % 2) * std::numbers::pi,
                                         Eigen::Vector3d::UnitX()))
                          .toRotationMatrix();
      pose.translation().z() = -static_cast<double>(k) * (2 * ElasticCushion::kHigh + apart);
      members.push_back({&layers.back()->body(), pose});
    }
    solver = std::make_unique<ContactSolver>(members);
  }
  // Advances a frame; only the top cushion has an obstacle. @param largest_move  m, step limit
  void advance(const Obstacles& obstacles,
               double largest_move = std::numeric_limits<double>::infinity()) {
    near_.assign(layers.size(), {nullptr, largest_move});
    near_.front().obstacles = &obstacles;
    report = solver->advance(near_);
  }
  void press(double depth) { advance(finger(depth)); }
  void let_go() {
    const CapsuleObstacles none;
    advance(none);
  }
  [[nodiscard]] Eigen::Isometry3f from_to(std::size_t from, std::size_t to) const {
    return (members[to].world_from_body.inverse() * members[from].world_from_body).cast<float>();
  }
  // m, largest penetration of a vertex of the upper cushion into the lower one.
  [[nodiscard]] double entry(std::size_t upper) const {
    MovingSurface lower(layers[upper + 1]->cushion.skin);
    lower.move(layers[upper + 1]->skin());
    float deepest = 0;
    const Eigen::Matrix3Xf above = layers[upper]->skin();
    for (const auto& x : above.colwise()) {
      const auto found = lower.nearest(from_to(upper, upper + 1) * Eigen::Vector3f(x), 0.01f);
      if (found) deepest = std::max(deepest, -found->distance);
    }
    return static_cast<double>(deepest);
  }
  // N, world frame: force on one cushion by obstacles, or by all other members.
  [[nodiscard]] Eigen::Vector3d force(std::size_t on, bool by_others) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const PointForce& at : layers[on]->body().forces()) {
      if ((at.by >= 0) == by_others) sum += at.force.cast<double>();
    }
    if (by_others) {
      for (const PressedPoint& point : solver->pressed_by_others(static_cast<int>(on))) {
        sum += point.force.cast<double>();
      }
    }
    return members[on].world_from_body.linear() * sum;
  }

 private:
  std::vector<ContactSolver::Near> near_;
};

}  // namespace palpable::test

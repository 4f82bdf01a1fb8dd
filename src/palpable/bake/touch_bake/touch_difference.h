/// @file
/// How far the answer to touch by a body's tables (response/touch_solver.h) is from full finite
/// elements with contact (solid/contact.h) on the same mesh, with the same contact points.
#pragma once

#include "palpable/bake/solid/contact.h"
#include "palpable/bake/touch_bake/skin_response.h"
#include "palpable/bake/touch_bake/touch_scenes.h"
#include "palpable/common/contact/obstacles.h"
#include "palpable/common/response/held_out_touch.h"
#include "palpable/common/response/touch_solver.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace palpable {

/// One scene at one depth: both answers, and how they differ.
struct TouchDifference {
  HeldOutTouch touch;
  int refined = 0;          ///< how many exact answers it has taken up
  double worst_vertex = 0;  ///< m, of the displacement
  TouchReport report;       ///< of the last frame
  double milliseconds = 0;  ///< of that frame
  double stress_milliseconds = 0;
  /// (3 x V) m of the skin's vertices, (V) Pa von Mises there.
  Eigen::Matrix3Xf displacement, true_displacement;
  Eigen::VectorXf von_mises, true_von_mises;
};

/// Of a state of the full solver: how far the skin's vertices moved since nothing but the preload
/// acted, (3 x V) m, and the von Mises stress there as the full solver recovers it, (V) Pa.
/// @param displacement  (3 x N) m, from the unloaded body
[[nodiscard]] Eigen::Matrix3Xd true_displacement(const SkinResponse& skin,
                                                 const Eigen::Matrix3Xd& displacement);
[[nodiscard]] Eigen::VectorXd true_von_mises(const SkinResponse& skin,
                                             const Eigen::Matrix3Xd& displacement);

/// What the full solver is pressed by, as obstacles of the contact solver.
class ExactObstacles : public Obstacles {
 public:
  /// @param gaps  outlives this
  explicit ExactObstacles(const ObstacleGaps& gaps);

  void find_gaps(std::span<const Eigen::Vector3f> places,
                 std::span<SurfaceGap> gaps) const override;
  [[nodiscard]] bool may_be_within(const Eigen::Vector3f& place, float reach) const override;

 private:
  const ObstacleGaps* gaps_;
  std::vector<Eigen::AlignedBox3f> boxes_;  // of its parts
  bool is_boxed_;                           // each part has one
  Eigen::AlignedBox3f all_;
};

/// Presses a scene in frames of at most 1.25 mm, by the full solver and by the tables, and compares
/// the two at the depths.
/// @param solver  of the model that `skin` belongs to
/// @param depths  m, rising
/// @param found   is called at each depth
/// @param refinements  so often the thing then rests there until an exact answer is taken up
///                     (response/refinement.h); `found` is called after each. The way on is the
///                     unrefined one
/// @returns why the full solver stopped before the last of them; empty if it did not
[[nodiscard]] std::string compare_touch(const EquilibriumSolver& solver, const SkinResponse& skin,
                                        const Preloaded* preloaded, TouchSolver& touch,
                                        double point_spacing, const TouchScene& scene,
                                        std::span<const double> depths,
                                        const std::function<void(const TouchDifference&)>& found,
                                        int refinements = 0);

}  // namespace palpable

/// @file
/// Compares the response to touch by a body's tables (response/touch_solver.h) with full finite
/// elements with contact (solid/contact.h) on the same mesh, with the same contact points.
#pragma once

#include "palpable/bake/solid/contact.h"
#include "palpable/bake/touch_bake/skin_response.h"
#include "palpable/bake/touch_bake/touch_scenes.h"
#include "palpable/common/contact/obstacles.h"
#include "palpable/common/response/stated_error.h"
#include "palpable/common/response/touch_solver.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace palpable {

/// One scene at one depth: the tables' response, the full-order solution, and their differences.
struct TouchDifference {
  HeldOutTouch touch;
  int refined = 0;          ///< how many refinements by full-order solutions were tried before
  double worst_vertex = 0;  ///< m, largest error of a vertex's displacement
  TouchReport report;       ///< of the last frame
  double milliseconds = 0;  ///< for the last unrefined frame by the tables
  double stress_milliseconds = 0;
  /// (3 x V) m, displacement of the skin's vertices; (V) Pa, von Mises stress there.
  Eigen::Matrix3Xf displacement, true_displacement;
  Eigen::VectorXf von_mises, true_von_mises;
};

/// For a state of the full solver: the displacement of the skin's vertices from the preloaded
/// state, (3 x V) m, and the von Mises stress there as the full solver recovers it, (V) Pa.
/// @param displacement  (3 x N) m, from the unloaded body
[[nodiscard]] Eigen::Matrix3Xd true_displacement(const SkinResponse& skin,
                                                 const Eigen::Matrix3Xd& displacement);
[[nodiscard]] Eigen::VectorXd true_von_mises(const SkinResponse& skin,
                                             const Eigen::Matrix3Xd& displacement);

/// The full solver's obstacle, in the form that the contact solver of the tables takes.
class ExactObstacles : public Obstacles {
 public:
  /// @param gaps  outlives this
  explicit ExactObstacles(const ObstacleGaps& gaps);

  void find_gaps(std::span<const Eigen::Vector3f> places,
                 std::span<SurfaceGap> gaps) const override;
  [[nodiscard]] bool may_be_within(const Eigen::Vector3f& place, float reach) const override;

 private:
  const ObstacleGaps* gaps_;
  std::vector<Eigen::AlignedBox3f> boxes_;  // of the capsules, which are its first parts
  bool is_boxed_;                           // every part has a box
  Eigen::AlignedBox3f all_;
};

/// Presses the body with a scene's obstacle, by the full solver and by the tables, in frames of at
/// most 1.25 mm (one that ends at a given depth may be 10 % longer), and compares the two at the
/// given depths.
/// @param solver       of the model that `skin` belongs to
/// @param depths       m, rising
/// @param found        is called at each depth
/// @param refinements  how often, at each depth, the obstacle is kept at rest until the tables have
///                     blended in a full-order solution (response/refinement.h); `found` is called
///                     after each. The next depth continues from the unrefined state
/// @param friction     Coulomb's coefficient in the full solution, which then makes four steps a
///                     frame; the tables know no friction
/// @returns why the full solver stopped before the last depth; empty if it did not
[[nodiscard]] std::string compare_touch(const EquilibriumSolver& solver, const SkinResponse& skin,
                                        const Preloaded* preloaded, TouchSolver& touch,
                                        double point_spacing, const TouchScene& scene,
                                        std::span<const double> depths,
                                        const std::function<void(const TouchDifference&)>& found,
                                        int refinements = 0, double friction = 0.0);

}  // namespace palpable

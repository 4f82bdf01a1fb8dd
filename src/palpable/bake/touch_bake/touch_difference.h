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
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace palpable {

/// One scene at one depth: the tables' response, the full-order solution, and their differences.
struct TouchDifference {
  HeldOutTouch touch;
  double dragged = 0;  ///< m, motion aside after the press
  /// Change of the full-order solution if all its steps are halved: relative L2 over the skin's
  /// vertices; nothing where that was not solved (ComparisonSettings::halves_steps)
  std::optional<double> half_step = {};
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
  /// @param gaps    outlives this
  /// @param before  with friction, that of the body: the obstacle of the frame before, with the
  ///                same parts; outlives this. Null: nothing rubs
  explicit ExactObstacles(const ObstacleGaps& gaps, const Obstacle* before = nullptr);

  void find_gaps(std::span<const Eigen::Vector3f> places,
                 std::span<SurfaceGap> gaps) const override;
  [[nodiscard]] bool may_be_within(const Eigen::Vector3f& place, float reach) const override;
  [[nodiscard]] float largest_friction(float of_body) const override {
    return before_ != nullptr ? of_body : 0.0f;
  }
  [[nodiscard]] std::optional<MaterialPoint> carried(const MaterialPoint& before) const override;
  [[nodiscard]] std::optional<Eigen::Vector3f> way_of(const MaterialPoint& now) const override;
  [[nodiscard]] const Obstacles* on_the_way(float done) const override;

 private:
  const ObstacleGaps* gaps_;
  const Obstacle* before_;
  std::vector<Eigen::AlignedBox3f> boxes_;  // of the capsules, which are its first parts
  bool is_boxed_;                           // every part has a box
  Eigen::AlignedBox3f all_;
  struct OnTheWay;
  mutable std::shared_ptr<const OnTheWay> on_the_way_;  // the last one
};

/// How the full-order solution is computed, and how often the tables adopt it.
struct ComparisonSettings {
  /// Coulomb's coefficient. That of the tables is the body's of the TouchSolver.
  double friction = 0;
  /// How often, at each depth, the obstacle is kept at rest until the tables have blended in a
  /// full-order solution (response/refinement.h).
  int refinements = 0;
  /// Whether the scene is solved once more with half the steps, for TouchDifference::half_step.
  bool halves_steps = false;
};

/// Presses the body with a scene's obstacle, by the full solver and by the tables, in frames of at
/// most 1.25 mm (one that ends at a given depth may be 10 % longer), and compares the two at the
/// given depths. The full solver makes one step a frame; with friction four, as the solution
/// depends on the path.
/// @param solver  of the model that `skin` belongs to
/// @param depths  m, rising
/// @param found   is called at each depth, and after each refinement there. The next depth
///                continues from the unrefined state
/// @returns why a full-order solution stopped before the last depth; empty if none did
[[nodiscard]] std::string compare_touch(const EquilibriumSolver& solver, const SkinResponse& skin,
                                        const Preloaded* preloaded, TouchSolver& touch,
                                        double point_spacing, const TouchScene& scene,
                                        std::span<const double> depths,
                                        const std::function<void(const TouchDifference&)>& found,
                                        const ComparisonSettings& settings = {});

/// The same for a thing that presses to `depth` (m) and is then dragged aside, perpendicular to its
/// way, in frames of at most 1.25 mm.
/// @param drags     m, rising; `found` is called at each
/// @param settings  without refinements and half steps
[[nodiscard]] std::string compare_drag(const EquilibriumSolver& solver, const SkinResponse& skin,
                                       const Preloaded* preloaded, TouchSolver& touch,
                                       double point_spacing, const TouchScene& scene, double depth,
                                       std::span<const double> drags,
                                       const std::function<void(const TouchDifference&)>& found,
                                       const ComparisonSettings& settings);

}  // namespace palpable

/// @file
/// How far the answer to touch by a body's tables (touch/touch_solver.h) is from full finite
/// elements with contact (solid/contact.h) on the same mesh, with the same contact points.
#pragma once

#include "palpable/solid/contact.h"
#include "palpable/touch/touch_solver.h"
#include "palpable/touch_bake/skin_response.h"

#include <Eigen/Core>

#include "bench/bake/touch_scenes.h"
#include <functional>
#include <string>
#include <vector>

namespace palpable {

/// One scene at one depth.
struct TouchDifference {
  PressingThing thing = PressingThing::kFinger;
  double depth = 0;         ///< m
  double displacement = 0;  ///< relative L2 over the skin's vertices
  double worst_vertex = 0;  ///< m
  double force = 0;         ///< of the resultant; of a squeeze, of the sum of all forces' norms
  double von_mises = 0;     ///< of the stress at the worst vertex, against the largest on the skin
  double penetration = 0;   ///< m, left at the contact points
  int candidates = 0;       ///< of the last frame
  double milliseconds = 0;  ///< of the frame
  double stress_milliseconds = 0;
};

/// The gaps to an obstacle, as a query of touch.
[[nodiscard]] GapQuery gaps_to(const ObstacleGaps& gaps);

/// A scene pressed to `deepest` in frames of 1.25 mm, by the full solver and by the tables; looked
/// at at 2.5, 5 and 10 mm as far as `deepest` goes. Where the full solver stops, the rest is left
/// out, and `stopped` says why.
/// @param solver  of the model that `skin` belongs to
[[nodiscard]] std::vector<TouchDifference> compare_touch(const EquilibriumSolver& solver,
                                                         const SkinResponse& skin,
                                                         const Preloaded* preloaded,
                                                         TouchSolver& touch, double point_spacing,
                                                         const TouchScene& scene, double deepest,
                                                         std::string& stopped);

/// What the table of the compliance leaves out, relative L2 over the skin: for smooth loads of 8 mm
/// radius along the normal at `count` random vertices that are not held.
[[nodiscard]] std::vector<double> compliance_errors(const SkinResponse& skin,
                                                    const Compliance& compliance, int count,
                                                    std::uint64_t seed);

/// The largest jump of a vertex from frame to frame, m, while a finger that is 4 mm deep slides
/// over the skin by 0.5 mm a frame.
[[nodiscard]] double largest_slide_jump(const SkinResponse& skin, TouchSolver& touch,
                                        std::uint64_t seed);

}  // namespace palpable

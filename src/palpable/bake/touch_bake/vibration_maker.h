/// @file
/// Makes the vibration modes of a body, which give it inertia (response/vibration_table.h).
#pragma once

#include "palpable/bake/touch_bake/skin_response.h"
#include "palpable/common/base/progress.h"
#include "palpable/common/response/compliance.h"
#include "palpable/common/response/vibration_table.h"

#include <numbers>
#include <vector>

namespace palpable {

struct InertiaSettings {
  double density = 0;      ///< kg/m^3, > 0
  double loss_factor = 0;  ///< of the material, 0 <= eta < 1
  int modes = 20;          ///< at least, >= 1
  /// rad/s: all modes below it as well. 60 Hz is twice the rate of frames; stiffer modes follow a
  /// load within a frame.
  double below = 2 * std::numbers::pi * 60;
};

/// Most modes of a body: with 200 of them a frame of 16,000 nodes would read 10 MB for its motion.
inline constexpr int kMostModesMade = 200;

/// The vibration modes at the nodes of the shell. @throws Error as vibration_modes()
[[nodiscard]] VibrationTable make_vibration(const SkinResponse& skin,
                                            const InertiaSettings& settings,
                                            const Progress& progress = {});

/// Of the compliance that is left without the modes, G - Phi Omega^-2 Phi^T, the smallest
/// eigenvalue as a ratio to the largest of G. Of exact tables it is not negative, since what is
/// left is the compliance of the other modes. Tables are rounded.
/// @param vertices  between which G is taken, none twice; 200 of them take half a second
[[nodiscard]] double smallest_residual_compliance(const ComplianceTable& table,
                                                  const VibrationTable& vibration,
                                                  const std::vector<int>& vertices);

/// How far the ratio above may be below 0: the rounding of tables, 2e-5 of the largest number of a
/// row, some of which add up.
inline constexpr double kResidualRounding = 1e-4;

/// Compares the tables with the modes at vertices that are spread over the skin.
/// @throws Error if less than nothing is left without the modes: a body with these tables would
/// gain
///         energy where it is touched
void expect_residual_compliance(const SkinResponse& skin, const ComplianceTable& table,
                                const VibrationTable& vibration);

}  // namespace palpable

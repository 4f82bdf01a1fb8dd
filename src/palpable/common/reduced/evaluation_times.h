/// @file
/// Measures how long a body takes to be evaluated on this machine.
#pragma once

#include "palpable/common/reduced/reduced_body.h"

namespace palpable {

/// Wall time of one evaluation on one core, microseconds: medians over sites and levels.
struct EvaluationTimes {
  double displacement_us = 0, stress_us = 0;
  double all_us = 0;  ///< displacement, stress and from it von Mises stress
  int repeats = 0;    ///< number of evaluations in each median
};

/// Evaluates in the order of a hand's touches: 20 increasing levels at one site, then at the next.
/// Further parameters are at their usual values. 400 repeats of a large body take about a second.
/// @param repeats  of each median, > 0
[[nodiscard]] EvaluationTimes evaluation_times(const ReducedBody& unsettled, int repeats = 400);

}  // namespace palpable

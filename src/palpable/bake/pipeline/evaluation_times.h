/// @file
/// What a body costs the live half, measured here and now.
#pragma once

#include "palpable/common/reduced/reduced_body.h"

namespace palpable {

/// Microseconds of one evaluation on one core, medians over sites and levels, by the clock on the
/// wall.
struct EvaluationTimes {
  double displacement_us = 0, stress_us = 0;
  double all_us = 0;  ///< displacement, stress and from it von Mises stress
  int repeats = 0;    ///< evaluations that each median is of
};

/// Evaluates as a hand goes: 20 levels up at one site, then at the next. Further parameters have
/// their own values. Takes about a second.
[[nodiscard]] EvaluationTimes evaluation_times(const ReducedBody& unsettled);

}  // namespace palpable

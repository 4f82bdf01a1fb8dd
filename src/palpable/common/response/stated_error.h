/// @file
/// An estimate of the error of a state against full finite elements: three indicators, which cost
/// next to nothing, are added up with fixed weights and multiplied by one factor per body, which
/// the body's held-out touches give (held_out_touch.h).
///
///     stated = factor * ( a entry + b beyond + c cross )
///
/// No indicator detects a wrong equilibrium: where the body has two states against the same
/// obstacle, as of a rim on a ridge, the tables may find one and full finite elements the other,
/// with every indicator small.
#pragma once

#include <optional>
#include <vector>

namespace palpable {

struct HeldOutTouch;

/// Error indicators, each a ratio to the displacement of the skin.
struct ErrorIndicators {
  double entry = 0;   ///< penetration of the deepest contact point / largest displacement
  double beyond = 0;  ///< what regions and cross terms add to the linear displacement, L2
  double cross = 0;   ///< the cross terms, which are known to second order only, L2
};

/// The weighted sum of the indicators, before it is multiplied by the body's factor.
[[nodiscard]] double unscaled_error(const ErrorIndicators& indicators);

/// Relative errors, defined as those of HeldOutTouch.
struct StatedError {
  double displacement = 0;  ///< L2 over the skin's vertices
  double von_mises = 0;     ///< largest over the vertices, ratio to the largest stress
};

/// The factors of a body by which the weighted sum of indicators becomes a stated error.
struct ErrorScale {
  double displacement = 0, von_mises = 0;
  [[nodiscard]] StatedError stated(const ErrorIndicators& indicators) const {
    const double sum = unscaled_error(indicators);
    return {displacement * sum, von_mises * sum};
  }
};

/// The factors with which the stated error is kOnTheSafeSide times the true error in the median of
/// the touches that have unscaled_error; nothing if fewer than kLeastTouches have it.
[[nodiscard]] std::optional<ErrorScale> error_scale(const std::vector<HeldOutTouch>& touches);

/// Ratio of the stated error to the true error in the median held-out touch. Above 1 because errors
/// scatter and 20 touches determine their median only to a quarter: with 1.3, touches that were not
/// used had 0.8 in the median, and more of them were over twice as wrong as stated (docs/touch.md).
inline constexpr double kOnTheSafeSide = 1.75;
/// Fewest held-out touches that give a factor.
inline constexpr int kLeastTouches = 8;

}  // namespace palpable

/// @file
/// An estimate of the state's error against full finite elements: three indicators that the state
/// gives at next to no cost, added up with fixed weights, times one factor for each body that its
/// held-out touches give (held_out_touch.h).
///
///     stated = factor * ( a entry + b beyond + c cross )
///
/// No indicator detects a snap to another equilibrium: where two states of the body are possible
/// against the same object, as of a rim on a ridge, the solution may be the other one of the two
/// with every indicator as small.
#pragma once

#include <optional>
#include <vector>

namespace palpable {

struct HeldOutTouch;

/// Shares of the skin's displacement.
struct ErrorSigns {
  double entry = 0;   ///< the deepest contact point's penetration, of the largest displacement
  double beyond = 0;  ///< what regions and cross terms add to the linear answer, L2
  double cross = 0;   ///< what the patches do to each other, of the second order alone, L2
};

/// The sum of signs before it is calibrated.
[[nodiscard]] double unscaled_error(const ErrorSigns& signs);

/// Relative errors as those of HeldOutTouch.
struct StatedError {
  double displacement = 0;  ///< L2 over the skin's vertices
  double von_mises = 0;     ///< of the stress at the worst vertex, against the largest on the skin
};

/// Factors of a body.
struct ErrorScale {
  double displacement = 0, von_mises = 0;
  [[nodiscard]] StatedError stated(const ErrorSigns& signs) const {
    const double sum = unscaled_error(signs);
    return {displacement * sum, von_mises * sum};
  }
};

/// So large that the stated error is kOnTheSafeSide times the true one in the median of the
/// touches whose signs are known; nothing for fewer than kLeastTouches of these.
[[nodiscard]] std::optional<ErrorScale> error_scale(const std::vector<HeldOutTouch>& touches);

/// Errors scatter around what is stated, and 20 touches know their median to a quarter. With 1.3,
/// new touches had 0.8 and more of them were over twice of what was stated (docs/touch.md).
inline constexpr double kOnTheSafeSide = 1.75;
inline constexpr int kLeastTouches = 8;

}  // namespace palpable

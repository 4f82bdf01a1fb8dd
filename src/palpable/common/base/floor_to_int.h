/// @file
/// Rounds coordinates down. With plain SSE2 std::floor is a function call, and a voxel look-up
/// would need three of them.
#pragma once

namespace palpable {

/// The largest whole number <= a, for |a| < 2^31.
[[nodiscard]] constexpr int floor_to_int(float a) {
  const int towards_zero = static_cast<int>(a);
  return towards_zero - (static_cast<float>(towards_zero) > a ? 1 : 0);
}
[[nodiscard]] constexpr int floor_to_int(double a) {
  const int towards_zero = static_cast<int>(a);
  return towards_zero - (static_cast<double>(towards_zero) > a ? 1 : 0);
}

}  // namespace palpable

/// @file
/// Rounds coordinates down. std::floor is a call on plain SSE2, and a voxel look-up needs three.
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

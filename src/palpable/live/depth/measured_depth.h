/// @file
/// What a frame's source measured, before limits leave out a part of it: the shares of the pixels,
/// and a sample of the depths themselves. A wrong unit or a wrong calibration shows here and
/// nowhere else: what the limits leave over looks like an ordinary, sparse depth image.
#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>

namespace palpable {

/// A histogram of depths from 1 mm to 4 km. A bin is 0.5 % to 0.8 % wide; depths outside the range
/// count in the first or last bin.
class DepthBins {
 public:
  /// @param Z  m, > 0 and finite
  void add(float Z);
  void add(const DepthBins& other);
  void clear();
  [[nodiscard]] std::uint64_t count() const { return count_; }
  /// m, below which this share of the depths lies, with an error up to 0.4 %; 0 without depths.
  [[nodiscard]] double percentile(double share) const;

 private:
  static constexpr std::size_t kBins = 22 * 128;
  std::array<std::uint32_t, kBins> bins_{};
  std::uint64_t count_ = 0;
};

/// The whole numbers in which a depth sensor delivers its depths, in a sample of neighbours.
struct DepthSteps {
  std::uint64_t values = 0;          ///< numbers that were looked at
  std::uint64_t values_by_256 = 0;   ///< of these, multiples of 256
  std::uint64_t changes = 0;         ///< neighbours in a row with different numbers
  std::uint64_t changes_by_256 = 0;  ///< of these, with a difference that is a multiple of 256
  int divisor = 0;                   ///< greatest common divisor of all numbers; 0: there are none
  /// A bit for each hash of a number: their count is at most that of the different numbers.
  std::bitset<1024> kinds;

  /// @param number  1 to 65534; `before`: of the pixel to the left, 0 if unknown
  void add(int number, int before);
  void add(const DepthSteps& other);
};

/// The depths between which a desk, a hand or a room is expected to have some, m.
inline constexpr float kNearScene = 0.1F;
inline constexpr float kFarScene = 5.0F;

/// A plain value of fixed size: filling it allocates nothing.
struct MeasuredDepth {
  double measured = 0;   ///< share of the pixels that the sensor or the matcher has measured
  double too_close = 0;  ///< share that is nearer than the searched range
  double too_far = 0;    ///< share that is farther than the largest depth (or behind infinity)
  double kept = 0;       ///< share of SeenFrame::depth that is known
  DepthBins bins;        ///< a sample of what was measured, `too_close` excepted
  std::uint64_t in_scene = 0;  ///< of the sample: from kNearScene to kFarScene
  DepthSteps steps;            ///< of a sensor with FrameFormat::depth_unit; else empty

  void clear();
  /// Adds a depth to the sample. @param Z  m; NaN and what is not above 0 are skipped
  void sample(float Z);
};

/// Rows between two rows of the sample: about 64 rows of an image are looked at.
[[nodiscard]] constexpr int sample_step(int height) { return height < 128 ? 1 : height / 64; }

}  // namespace palpable

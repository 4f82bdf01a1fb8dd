/// @file
/// Detects that the quality of the depth has dropped. The causes are not visible in the picture:
/// misaligned rows, a lens out of focus or a dark room leave an ordinary picture with hardly any
/// depth.
#pragma once

namespace palpable {

enum class DepthTrouble {
  kNone,
  kRowsOff,   ///< matched points lie on different rows in spite of the row correction
  kFewDepths  ///< hardly any pixels have a depth, or far fewer than before
};

struct DepthWatchSettings {
  int frames = 24;           ///< successive bad frames after which a trouble is reported
  double rows_off_px = 0.5;  ///< row error, px of the full images; at 0.5 half the depths are lost
  double few = 0.05;         ///< share of the pixels below which the density is too low
  double of_best = 0.25;     ///< share of the best density so far below which it is too low
};

/// Must be called with every frame, in order. Does not allocate.
class DepthWatch {
 public:
  explicit DepthWatch(const DepthWatchSettings& settings = {}) : settings_(settings) {}

  /// @param density       share of the pixels that have a depth or are marked as too close
  /// @param row_error_px  remaining row error after the correction; NaN: not measured in this
  ///                      frame, which leaves the count of bad frames unchanged
  [[nodiscard]] DepthTrouble look(double density, double row_error_px);

 private:
  DepthWatchSettings settings_;
  double smooth_ = 0;  // exponential average of the density over about 16 frames
  double best_ = 0;    // the largest value of smooth_
  int seen_ = 0, few_ = 0, rows_off_ = 0;
};

}  // namespace palpable

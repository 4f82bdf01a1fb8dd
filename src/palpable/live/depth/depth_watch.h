/// @file
/// Is depth still measured as it should be? What makes it bad makes no noise: rows that are out of
/// line, a lens out of focus or a dark room leave a picture that looks right and hardly any depth.
#pragma once

namespace palpable {

enum class DepthTrouble {
  kNone,
  kRowsOff,   ///< matched points lie on different rows, and the correction does not mend it
  kFewDepths  ///< of the picture hardly anything has a depth, or far less than before
};

struct DepthWatchSettings {
  int frames = 24;           ///< in a row for which something must be wrong before it is told
  double rows_off_px = 0.5;  ///< row error, px of the full images, that costs half of the depths
  double few = 0.05;         ///< share of the pixels
  double of_best = 0.25;     ///< share of the best density so far below which it has collapsed
};

/// Told of every frame, in order. Allocates nothing.
class DepthWatch {
 public:
  explicit DepthWatch(const DepthWatchSettings& settings = {}) : settings_(settings) {}

  /// @param density       share of the pixels that have a depth or are marked as too close
  /// @param row_error_px  what is left after the correction; NaN: not measured in this frame, which
  ///                      changes nothing of what was known
  [[nodiscard]] DepthTrouble look(double density, double row_error_px);

 private:
  DepthWatchSettings settings_;
  double smooth_ = 0;  // density, over some 16 frames
  double best_ = 0;    // of the smooth ones
  int seen_ = 0, few_ = 0, rows_off_ = 0;
};

}  // namespace palpable

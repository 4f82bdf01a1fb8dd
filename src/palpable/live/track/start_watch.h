/// @file
/// Detects whether the camera has moved before there is a keyframe. A bare wall, a dark room or a
/// covered lens show nothing that could be tracked; but as long as the camera has not moved since
/// the start, its pose is known.
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/live/depth/depth_noise.h"
#include "palpable/live/track/still_watch.h"

#include <array>
#include <cstddef>

namespace palpable {

/// Compares each frame with the first one that could be compared: by patches of its picture, or by
/// 48 x 36 samples of its depths if the picture has no texture. It does not detect a camera that
/// slides along a wall without texture.
class StartWatch {
 public:
  explicit StartWatch(const DepthNoise& noise) : noise_(noise) {}

  /// Does not allocate after the first view that can be compared.
  /// @param depth  Z in m, unknown NaN; of any size, the same in all frames
  /// @return kUnclear until there was a view that can be compared
  [[nodiscard]] Stillness look(const GrayImage& image, const DepthImage& depth);

 private:
  static constexpr int kAcross = 48;
  static constexpr int kDown = 36;
  using Samples = std::array<float, kAcross * kDown>;  // Z in m

  [[nodiscard]] static Samples samples_of(const DepthImage& depth);
  [[nodiscard]] Stillness compare(const Samples& now) const;

  DepthNoise noise_;
  bool begun_ = false;
  StillWatch picture_;
  Samples first_{};
};

}  // namespace palpable

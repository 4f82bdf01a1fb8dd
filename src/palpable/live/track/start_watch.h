/// @file
/// Has the camera moved before there was a keyframe? A bare wall, a dark room or a covered lens
/// show nothing that could be tracked; but while the camera stands where it began, its pose is
/// known.
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/live/depth/depth_noise.h"
#include "palpable/live/track/still_watch.h"

#include <array>
#include <cstddef>

namespace palpable {

/// Compares each frame with the first one that showed something: by patches of its picture, or by
/// 48 x 36 of its depths where the picture has no texture. It does not notice a camera that slides
/// along a wall that looks the same everywhere.
class StartWatch {
 public:
  explicit StartWatch(const DepthNoise& noise) : noise_(noise) {}

  /// Takes no memory after the first view that shows something.
  /// @param depth  Z in m, unknown NaN; of any size, in all frames the same
  /// @return kUnclear as long as nothing has been seen that could be compared
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

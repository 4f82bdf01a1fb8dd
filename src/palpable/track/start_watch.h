/// @file
/// Has the camera moved before anything could be followed? A bare wall, a dark room or a covered
/// lens leave nothing to track; where it still stands as in the beginning its frames have a pose.
#pragma once

#include "palpable/depth/depth_noise.h"
#include "palpable/geometry/image.h"
#include "palpable/track/still_watch.h"

#include <array>
#include <cstddef>

namespace palpable {

/// Compares with the first view that shows something: by its picture, and where that says nothing
/// by its depths. A wall along which the camera slides, as like itself there as here, is not told.
class StartWatch {
 public:
  explicit StartWatch(const DepthNoise& noise) : noise_(noise) {}

  /// Takes no memory after the first view that shows something.
  /// @param depth  Z in m, unknown NaN; of any size, always the same
  [[nodiscard]] Stillness look(const GrayImage& image, const DepthImage& depth);

 private:
  static constexpr int kAcross = 48;
  static constexpr int kDown = 36;
  using Samples = std::array<float, static_cast<std::size_t>(kAcross* kDown)>;  // Z in m

  [[nodiscard]] static Samples samples_of(const DepthImage& depth);
  [[nodiscard]] Stillness compare(const Samples& now) const;

  DepthNoise noise_;
  bool begun_ = false;
  StillWatch picture_;
  Samples first_{};
};

}  // namespace palpable

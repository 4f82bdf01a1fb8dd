/// @file
/// A wall with a noise texture seen by a colour + depth camera, for tests.
#pragma once

#include "palpable/common/geometry/frame.h"

#include <Eigen/Core>

#include <cmath>
#include <cstdint>

namespace palpable::test {

/// m, distance from the camera to the wall.
inline constexpr double kWallZ = 0.8;

/// Colour + depth, both without sensor noise.
inline FrameFormat wall_format() {
  FrameFormat format;
  format.kind = FrameFormat::Kind::kColorDepth;
  format.width = 161;
  format.height = 121;
  format.depth_camera = {161, 121, 250, 250, 80, 60};
  return format;
}

/// Frame `number` at 30 frames a second, for a camera `x` m to the right and `z` m nearer.
inline Frame frame_of_wall(int number, double x, double z = 0) {
  const FrameFormat format = wall_format();
  const auto noise = [](int i, int j) {
    auto h =
        static_cast<std::uint32_t>(i) * 0x9E3779B1U ^ static_cast<std::uint32_t>(j) * 0x85EBCA77U;
    h = (h ^ (h >> 15)) * 0x2C1B3C6DU;
    return static_cast<double>((h ^ (h >> 12)) & 0xFF);
  };
  Frame frame;
  frame.number = number;
  frame.time = number / 30.0;
  frame.depth = DepthImage(format.width, format.height, static_cast<float>(kWallZ - z));
  frame.left = ColorImage(format.width, format.height);
  for (int v = 0; v < format.height; ++v) {
    for (int u = 0; u < format.width; ++u) {
      const Eigen::Vector3d at = format.depth_camera.unproject(u, v, kWallZ - z);
      const double a = (at.x() + x) / 0.016, b = at.y() / 0.016;  // 5 px
      const int i = static_cast<int>(std::floor(a)), j = static_cast<int>(std::floor(b));
      const double s = a - i, t = b - j;
      const double value = (1 - t) * ((1 - s) * noise(i, j) + s * noise(i + 1, j)) +
                           t * ((1 - s) * noise(i, j + 1) + s * noise(i + 1, j + 1));
      const auto grey = static_cast<std::uint8_t>(value);
      frame.left(u, v) = {grey, grey, grey};
    }
  }
  return frame;
}

}  // namespace palpable::test

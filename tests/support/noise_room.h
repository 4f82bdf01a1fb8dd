/// @file
/// A room of four walls with a noise texture, and the walk of a camera around it with a drift, for
/// tests of loop closure.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/frame.h"
#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/rigid.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace palpable::test {

/// A random number in 0 .. 1 for cell (i, j) of a grid on a wall.
inline double noise_at(int i, int j, unsigned wall) {
  auto h = static_cast<std::uint32_t>(i) * 0x9E3779B1U ^
           static_cast<std::uint32_t>(j) * 0x85EBCA77U ^ wall * 0xC2B2AE3DU;
  h ^= h >> 15;
  h *= 0x2C1B3C6DU;
  h ^= h >> 12;
  h *= 0x297A2D39U;
  h ^= h >> 15;
  return static_cast<double>(h & 0xFFFF) / 65535.0;
}

/// Grey level at the point (s, t), m, of a wall: interpolated noise on grids of 0.2,
/// 0.06 and 0.02 m.
inline double wall_texture(double s, double t, unsigned wall) {
  double value = 0;
  for (const double cell : {0.2, 0.06, 0.02}) {
    const double a = s / cell, b = t / cell;
    const int i = static_cast<int>(std::floor(a)), j = static_cast<int>(std::floor(b));
    const double x = a - i, y = b - j;
    const double sx = x * x * (3 - 2 * x), sy = y * y * (3 - 2 * y);
    value += (1 - sy) * ((1 - sx) * noise_at(i, j, wall) + sx * noise_at(i + 1, j, wall)) +
             sy * ((1 - sx) * noise_at(i, j + 1, wall) + sx * noise_at(i + 1, j + 1, wall));
  }
  return 20 + 70 * value;
}

/// The camera of both colour and depth.
inline constexpr PinholeCamera kCreepingCamera{640, 360, 350, 350, 319.5, 179.5};

/// A full circle of radius 0.7 m about the centre of the room, looking outwards, and a little more.
inline constexpr int kCreepingCircle = 150, kCreepingFrames = kCreepingCircle + 20;

/// The pose relative to the first frame's camera, which is 0.8 m from a wall. The
/// walls are 3 m wide.
inline Rigid3 creeping_pose(int n) {
  const Rigid3 room_from_first(Eigen::Translation3d(0, 0, 0.7));
  const double angle = 2 * std::numbers::pi * n / kCreepingCircle;
  return room_from_first.inverse() * Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()) *
         room_from_first;
}

/// The picture and depth of frame `n`. The scale of the depth grows by h = 0.2 and returns to 1.
/// The integral of scale error and path is 4 h / pi * 0.7 m: a tracker has an error of 0.18 m at
/// the end of the circle, 78 px in the picture, which exceeds the search range for old landmarks.
inline void creeping_view(int n, GrayImage& gray, DepthImage& depth) {
  const PinholeCamera& camera = kCreepingCamera;
  const Rigid3 room_from_camera = Eigen::Translation3d(0, 0, 0.7) * creeping_pose(n);
  const double part = std::min(1.0, static_cast<double>(n) / kCreepingCircle);
  const double scale = 1 + 0.2 * (1 - std::abs(2 * part - 1));
  gray.resize(camera.width, camera.height);
  depth.resize(camera.width, camera.height);
  const Eigen::Vector3d eye = room_from_camera.translation();
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector3d ray = room_from_camera.linear() * camera.unproject(x, y, 1);
      const auto Z_at = [&](int axis) {
        return (std::copysign(1.5, ray(axis)) - eye(axis)) / ray(axis);
      };
      const bool by_z = std::abs(ray.x()) < 1e-9 || (std::abs(ray.z()) > 1e-9 && Z_at(2) < Z_at(0));
      const double Z = by_z ? Z_at(2) : Z_at(0);
      const Eigen::Vector3d at = eye + Z * ray;
      const unsigned wall = (by_z ? 1U : 3U) + (at(by_z ? 2 : 0) > 0 ? 1U : 0U);
      gray(x, y) = static_cast<std::uint8_t>(wall_texture(by_z ? at.x() : at.z(), at.y(), wall));
      depth(x, y) = static_cast<float>(scale * Z);
    }
  }
}

inline FrameFormat creeping_format() {
  FrameFormat format;
  format.kind = FrameFormat::Kind::kColorDepth;
  format.width = kCreepingCamera.width;
  format.height = kCreepingCamera.height;
  format.depth_camera = kCreepingCamera;
  return format;
}

/// The same as a frame at 30 frames a second.
inline Frame creeping_frame(int n) {
  Frame frame;
  frame.number = n;
  frame.time = n / 30.0;
  GrayImage gray;
  creeping_view(n, gray, frame.depth);
  frame.left = ColorImage(gray.width(), gray.height());
  std::transform(gray.begin(), gray.end(), frame.left.begin(), [](std::uint8_t y) {
    return Rgb{y, y, y};
  });
  return frame;
}

}  // namespace palpable::test

/// @file
/// Squares in front of the synthetic desk's camera: scenes whose pictures can be computed by hand.
#pragma once

#include "palpable/desk/film/desk_renderer.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace palpable::test {

inline constexpr const char* kNoGl =
    "no OpenGL 4.5 context here (Mesa's libegl1 and libgl1-mesa-dri are enough)";

/// The desk frame equals the left camera's frame, so that positions are those that
/// the left eye sees.
inline const Rigid3 kSame = Rigid3::Identity();

inline PaintedMesh square(const Eigen::Vector3d& centre, double half, int image) {
  PaintedMesh mesh;
  mesh.image = image;
  for (const auto& [x, y] : {std::pair(-1, -1), {1, -1}, {1, 1}, {-1, 1}}) {
    const Eigen::Vector3d at = centre + half * Eigen::Vector3d(x, y, 0.0);
    const Eigen::Vector2d uv(0.5 + 0.5 * x, 0.5 + 0.5 * y);
    mesh.vertices.push_back(
        {at.cast<float>(), Eigen::Vector3f(0, 0, -1), uv.cast<float>(), {1, 0, 9, 9}});
  }
  mesh.indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

/// A soft bright spot on black: unlike that of an edge, its position does not depend on how a
/// triangle covers pixels.
inline ColorImage spot_image() {
  ColorImage image(64, 64);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const double r2 = (x - 31.5) * (x - 31.5) + (y - 31.5) * (y - 31.5);
      const auto value = static_cast<std::uint8_t>(std::lround(250.0 * std::exp(-r2 / 200.0)));
      image(x, y) = {value, value, value};
    }
  return image;
}

inline DeskScene scene_of(std::vector<PaintedMesh> meshes) {
  DeskScene scene;
  scene.images = {ColorImage(4, 4, Rgb{170, 170, 170}), spot_image()};
  scene.meshes = std::move(meshes);
  return scene;
}

inline std::optional<DeskRenderer> renderer_of(const DeskScene& scene, std::uint64_t seed,
                                               const SensorFaults& faults) {
  DeskLook look;
  look.seed = seed;
  Result<DeskRenderer> made = DeskRenderer::make({zed_mini_rig(), faults, kSame}, scene, look);
  if (!made.ok()) return std::nullopt;
  return std::move(made).value();
}

/// A frame with a fixed camera and fixed objects.
inline DeskMoment still(int frame, std::vector<HandCapsule> hand = {}) {
  return {frame, [](double) { return kSame; },
          [hand = std::move(hand)](double) {
            return Movers{hand, std::nullopt};
          },
          RigState{}};
}

inline double luma(const Rgb& c) { return 0.299 * c.r + 0.587 * c.g + 0.114 * c.b; }

/// The centroid of the brightness in a window around `near`.
inline Eigen::Vector2d bright_spot(const ColorImage& image, const Eigen::Vector2d& near) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double weight = 0.0;
  const auto u = static_cast<int>(std::lround(near.x()));
  const auto v = static_cast<int>(std::lround(near.y()));
  for (int y = std::max(0, v - 13); y <= std::min(image.height() - 1, v + 13); ++y)
    for (int x = std::max(0, u - 13); x <= std::min(image.width() - 1, u + 13); ++x) {
      const double light = std::pow(luma(image(x, y)) / 255.0, 2.0);  // the sensor stores the root
      if (light < 0.003) continue;                                    // noise on black
      sum += light * Eigen::Vector2d(x, y);
      weight += light;
    }
  return sum / weight;
}

/// A sensor without noise, gain, vignetting and row error.
inline constexpr SensorFaults kFaultless{0.0, 1.0, 0.0, 0.0};

/// A renderer of a grey wall at 1 m, made once for each kind of faults in this process, because a
/// context and its programs take a second. Null without OpenGL. It is never destroyed, because at
/// the end of the process the driver's statics may be destroyed first.
inline DeskRenderer* wall_renderer(const SensorFaults& faults) {
  using Key = std::array<double, 4>;
  static auto& made = *new std::map<Key, std::optional<DeskRenderer>>;
  const Key key = {faults.noise_grey_levels, faults.right_gain, faults.vignetting,
                   faults.row_error_px};
  if (!made.contains(key))
    made[key] = renderer_of(scene_of({square({0, 0, 1}, 5.0, 0)}), 1, faults);
  return made[key] ? &*made[key] : nullptr;
}

}  // namespace palpable::test

#include "palpable/live/view/sensed_picture.h"

#include "palpable/live/render/color_map.h"
#include "palpable/live/render/legend.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>

namespace palpable {
namespace {

constexpr Rgb kUnknown{70, 70, 74};
constexpr Rgb kTooCloseColor{220, 30, 30};

// A table of color_of_share(), since it is needed for every pixel.
const std::array<Rgb, 256>& colors() {
  static const std::array<Rgb, 256> table = [] {
    std::array<Rgb, 256> made{};
    for (std::size_t i = 0; i < made.size(); ++i) {
      made[i] = color_of_share(static_cast<float>(i) / 255.0f);
    }
    return made;
  }();
  return table;
}

Rgb color_of_depth(float Z) {
  constexpr double kFar = 1 / kFarthestShown, kNear = 1 / kNearestShown;
  const double share = (1 / static_cast<double>(Z) - kFar) / (kNear - kFar);
  return colors()[static_cast<std::size_t>(std::lround(255 * std::clamp(share, 0.0, 1.0)))];
}

void write(const std::string& line, ColorImage& picture) {
  draw_caption(picture, std::array{line}, legend_scale(picture.height()));
}

}  // namespace

void draw_depth(const Scene& scene, ColorImage& picture) {
  const SeenFrame& seen = scene.seen;
  picture.resize(seen.color.width(), seen.color.height());
  const int factor = seen.color.width() / seen.depth.width();
  for (int y = 0; y < picture.height(); ++y) {
    const int v = std::min(y / factor, seen.depth.height() - 1);
    Rgb* row = picture.row(y);
    for (int x = 0; x < picture.width(); ++x) {
      const int u = std::min(x / factor, seen.depth.width() - 1);
      const float Z = seen.depth(u, v);
      const bool too_close = !seen.too_close.empty() && seen.too_close(u, v) != 0;
      row[x] = Z > 0 ? color_of_depth(Z) : too_close ? kTooCloseColor : kUnknown;
    }
  }
  write("depth: dark 2 m, bright 0.15 m   grey not known   red too close to be measured", picture);
}

void draw_moving(const Scene& scene, ColorImage& picture) {
  const SeenFrame& seen = scene.seen;
  picture = seen.color;
  const int factor = scene.moving.empty() ? 1 : seen.color.width() / scene.moving.width();
  const auto dark = [](std::uint8_t value) { return static_cast<std::uint8_t>(value / 3); };
  const auto mixed = [](int a, int b) { return static_cast<std::uint8_t>((a + b) / 2); };
  for (int y = 0; y < picture.height(); ++y) {
    Rgb* row = picture.row(y);
    for (int x = 0; x < picture.width(); ++x) {
      const Rgb at = row[x];
      const bool moves = !scene.moving.empty() &&
                         scene.moving(std::min(x / factor, scene.moving.width() - 1),
                                      std::min(y / factor, scene.moving.height() - 1)) != 0;
      row[x] = moves ? Rgb{mixed(at.r, kMovingColor.r), mixed(at.g, kMovingColor.g),
                           mixed(at.b, kMovingColor.b)}
                     : Rgb{dark(at.r), dark(at.g), dark(at.b)};
    }
  }
  write(scene.moving.empty() ? "what moves is not known" : "orange: moves", picture);
}

}  // namespace palpable

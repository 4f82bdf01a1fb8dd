#include "palpable/desk/score/occlusion.h"

#include "palpable/common/base/contract.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace palpable {
namespace {

void expect_one_size(const SightImage& a, const SightImage& b) {
  PALPABLE_EXPECT(a.width() == b.width() && a.height() == b.height(),
                  "what is compared has one size");
}

constexpr std::array<std::array<int, 2>, 4> kNeighbours{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};

MaskImage border_of(const SightImage& sight) {
  MaskImage border(sight.width(), sight.height(), 0);
  for (int y = 0; y < sight.height(); ++y) {
    for (int x = 0; x < sight.width(); ++x) {
      if (sight(x, y) != Sight::kVisible) continue;
      for (const auto& [dx, dy] : kNeighbours) {
        const int u = x + dx;
        const int v = y + dy;
        if (u < 0 || v < 0 || u >= sight.width() || v >= sight.height()) continue;
        if (sight(u, v) == Sight::kHidden) border(x, y) = 255;
      }
    }
  }
  return border;
}

struct Step {
  int dx;
  int dy;
  double length;
};

// All pixel offsets shorter than the largest error, sorted by length: the length of the first one
// that hits the other border is the distance.
std::vector<Step> steps_outwards() {
  std::vector<Step> steps;
  for (int dy = -kLargestBorderError; dy <= kLargestBorderError; ++dy) {
    for (int dx = -kLargestBorderError; dx <= kLargestBorderError; ++dx) {
      const double length = std::hypot(dx, dy);
      if (length < kLargestBorderError) steps.push_back({dx, dy, length});
    }
  }
  std::sort(steps.begin(), steps.end(),
            [](const Step& a, const Step& b) { return a.length < b.length; });
  return steps;
}

void add_distances(const MaskImage& from, const MaskImage& to, BorderError& error) {
  static const std::vector<Step> steps = steps_outwards();
  for (int y = 0; y < from.height(); ++y) {
    for (int x = 0; x < from.width(); ++x) {
      if (from(x, y) == 0) continue;
      double distance = kLargestBorderError;
      for (const Step& step : steps) {
        const int u = x + step.dx;
        const int v = y + step.dy;
        if (u < 0 || v < 0 || u >= to.width() || v >= to.height() || to(u, v) == 0) continue;
        distance = step.length;
        break;
      }
      error.sum_px += distance;
      ++error.pixels;
    }
  }
}

}  // namespace

SightImage true_sight(const DepthImage& body_depth, const DepthImage& true_depth) {
  PALPABLE_EXPECT(
      true_depth.width() == body_depth.width() && true_depth.height() == body_depth.height(),
      "both depths have one size");
  SightImage sight(body_depth.width(), body_depth.height(), Sight::kNoBody);
  for (std::size_t i = 0; i < sight.size(); ++i) {
    const float body = body_depth.data()[i];
    if (std::isnan(body)) continue;
    const bool hidden = true_depth.data()[i] < body;  // false for NaN
    sight.data()[i] = hidden ? Sight::kHidden : Sight::kVisible;
  }
  return sight;
}

SightImage drawn_sight(const MaskImage& visible, const DepthImage& body_depth) {
  const int width = body_depth.width();
  const int height = body_depth.height();
  const bool same = visible.width() == width && visible.height() == height;
  const bool twice = visible.width() == 2 * width && visible.height() == 2 * height;
  PALPABLE_EXPECT(same || twice, "the mask is as large as the depth, or twice");
  SightImage sight(width, height, Sight::kNoBody);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      bool drawn = false;
      if (same) {
        drawn = visible(x, y) != 0;
      } else {
        const int set = (visible(2 * x, 2 * y) != 0) + (visible(2 * x + 1, 2 * y) != 0) +
                        (visible(2 * x, 2 * y + 1) != 0) + (visible(2 * x + 1, 2 * y + 1) != 0);
        drawn = set >= 2;
      }
      if (drawn) {
        sight(x, y) = Sight::kVisible;
      } else if (!std::isnan(body_depth(x, y))) {
        sight(x, y) = Sight::kHidden;
      }
    }
  }
  return sight;
}

MaskOverlap overlap_of(const SightImage& truth, const SightImage& drawn) {
  expect_one_size(truth, drawn);
  MaskOverlap overlap;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const bool is = truth.data()[i] == Sight::kVisible;
    const bool shown = drawn.data()[i] == Sight::kVisible;
    overlap.both += is && shown;
    overlap.either += is || shown;
    overlap.body += truth.data()[i] != Sight::kNoBody;
    overlap.hidden += truth.data()[i] == Sight::kHidden;
  }
  return overlap;
}

MaskOverlap compare_visible(const MaskImage& visible, const DepthImage& body_depth,
                            const DepthImage& true_depth) {
  return overlap_of(true_sight(body_depth, true_depth), drawn_sight(visible, body_depth));
}

BorderError border_error(const SightImage& truth, const SightImage& drawn) {
  expect_one_size(truth, drawn);
  const MaskImage true_border = border_of(truth);
  const MaskImage drawn_border = border_of(drawn);
  BorderError error;
  add_distances(true_border, drawn_border, error);
  add_distances(drawn_border, true_border, error);
  return error;
}

bool crosses_outline(const SightImage& truth, const MaskImage& moving) {
  const bool everywhere = moving.empty();
  PALPABLE_EXPECT(
      everywhere || (moving.width() == truth.width() && moving.height() == truth.height()),
      "what moves has the size of the truth");
  const auto moves = [&](int x, int y) { return everywhere || moving(x, y) != 0; };
  bool leaves_body = false;
  bool leaves_sight = false;
  for (int y = 0; y < truth.height(); ++y) {
    for (int x = 0; x < truth.width(); ++x) {
      if (truth(x, y) != Sight::kHidden || !moves(x, y)) continue;
      for (const auto& [dx, dy] : kNeighbours) {
        const int u = x + dx;
        const int v = y + dy;
        if (u < 0 || v < 0 || u >= truth.width() || v >= truth.height()) continue;
        leaves_body = leaves_body || (truth(u, v) == Sight::kNoBody && moves(u, v));
        leaves_sight = leaves_sight || truth(u, v) == Sight::kVisible;
      }
      if (leaves_body && leaves_sight) return true;
    }
  }
  return false;
}

Flicker flicker_between(const SightImage& truth_before, const SightImage& drawn_before,
                        const SightImage& truth, const SightImage& drawn) {
  expect_one_size(truth, truth_before);
  expect_one_size(truth, drawn);
  expect_one_size(truth, drawn_before);
  Flicker flicker;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Sight sight = truth.data()[i];
    if (sight == Sight::kNoBody || sight != truth_before.data()[i]) continue;
    ++flicker.pixels;
    flicker.changed += drawn.data()[i] != drawn_before.data()[i];
  }
  return flicker;
}

}  // namespace palpable

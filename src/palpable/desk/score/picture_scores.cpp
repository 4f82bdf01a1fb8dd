#include "palpable/desk/score/picture_scores.h"

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

MaskScore& MaskScore::operator+=(const MaskScore& other) {
  truth += other.truth;
  found += other.found;
  both += other.both;
  pixels += other.pixels;
  return *this;
}

std::optional<double> MaskScore::iou() const {
  if (truth == 0) return std::nullopt;
  return share_of(both, truth + found - both);
}
std::optional<double> MaskScore::recall() const { return share_of(both, truth); }
std::optional<double> MaskScore::false_alarms() const { return share_of(found - both, pixels); }

MaskScore compare_masks(const GrayImage& truth, std::uint8_t bit, const MaskImage& found) {
  PALPABLE_EXPECT(truth.width() == found.width() && truth.height() == found.height(),
                  "masks of one frame have one size");
  MaskScore score;
  score.pixels = static_cast<std::int64_t>(truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const bool is_true = (truth.data()[i] & bit) != 0;
    const bool is_found = found.data()[i] != 0;
    score.truth += is_true;
    score.found += is_found;
    score.both += is_true && is_found;
  }
  return score;
}

MaskScore missing_mask(const GrayImage& truth, std::uint8_t bit) {
  MaskScore score;
  for (const std::uint8_t label : truth) score.truth += (label & bit) != 0;
  return score;
}

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

MaskImage half_of(const MaskImage& mask) {
  MaskImage half(mask.width() / 2, mask.height() / 2);
  for (int y = 0; y < half.height(); ++y) {
    for (int x = 0; x < half.width(); ++x) {
      const int set = (mask(2 * x, 2 * y) != 0) + (mask(2 * x + 1, 2 * y) != 0) +
                      (mask(2 * x, 2 * y + 1) != 0) + (mask(2 * x + 1, 2 * y + 1) != 0);
      half(x, y) = set >= 2 ? 255 : 0;
    }
  }
  return half;
}

SightImage drawn_sight(const MaskImage& visible, const DepthImage& body_depth) {
  SightImage sight(body_depth.width(), body_depth.height(), Sight::kNoBody);
  const bool twice = visible.width() == 2 * sight.width() && visible.height() == 2 * sight.height();
  const MaskImage mask = twice ? half_of(visible) : visible;
  PALPABLE_EXPECT(mask.width() == sight.width() && mask.height() == sight.height(),
                  "the mask is as large as the depth, or twice");
  for (std::size_t i = 0; i < sight.size(); ++i) {
    if (mask.data()[i] != 0) {
      sight.data()[i] = Sight::kVisible;
    } else if (!std::isnan(body_depth.data()[i])) {
      sight.data()[i] = Sight::kHidden;
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

#include "palpable/live/depth/pair_fit.h"

#include "palpable/common/base/contract.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <vector>

namespace palpable {
namespace {

constexpr int kReach = 4;  // px from the middle of a window to its sides
constexpr int kSide = 2 * kReach + 1;
constexpr std::size_t kMostPlaces = 60;
constexpr std::size_t kLeastPlaces = 20;  // points that must be found; as in RowWatchSettings
// Smallest mean difference between neighbouring pixels, horizontally and vertically, grey levels. A
// window with less shows a plain surface or a single edge, which would be found on many rows.
constexpr int kLeastTexture = 2;
// Largest mean difference between a window and its partner, grey levels. The limit is half of the
// window's mean difference between neighbouring pixels if that is larger, because a window that is
// displaced by half a pixel differs by so much.
constexpr int kLargestDifference = 10;
constexpr double kAgreeing = 0.6;  // share of the points that must agree
// px of images at half the size, from which a row error is a misfit. The row watch corrects smaller
// ones, up to 2.5 px of the full images.
constexpr double kLeastRowsOff = 1.5;

struct Place {
  int x = 0, y = 0;
  int texture = 0;
};

int texture_of(const GrayImage& image, int x, int y) {
  int along = 0;
  int across = 0;
  for (int v = y - kReach; v <= y + kReach; ++v) {
    for (int u = x - kReach; u <= x + kReach; ++u) {
      along += std::abs(image(u + 1, v) - image(u, v));
      across += std::abs(image(u, v + 1) - image(u, v));
    }
  }
  return std::min(along, across);
}

// Points with strong texture: the best of a few positions in each cell, and of those kMostPlaces.
std::vector<Place> textured_places(const GrayImage& image) {
  constexpr int kCell = 16;
  constexpr int kStep = 4;
  const int margin = kReach + 1;
  std::vector<Place> places;
  for (int top = margin; top + kCell <= image.height() - margin; top += kCell) {
    for (int left = margin; left + kCell <= image.width() - margin; left += kCell) {
      Place best;
      for (int y = top; y < top + kCell; y += kStep) {
        for (int x = left; x < left + kCell; x += kStep) {
          const int texture = texture_of(image, x, y);
          if (texture > best.texture) best = {x, y, texture};
        }
      }
      if (best.texture >= kLeastTexture * kSide * kSide) places.push_back(best);
    }
  }
  // Takes points that are spread over the picture instead of those with the strongest texture,
  // because repeated texture (leaves) is matched wrongly.
  if (places.size() > kMostPlaces) {
    for (std::size_t i = 0; i < kMostPlaces; ++i)
      places[i] = places[i * places.size() / kMostPlaces];
    places.resize(kMostPlaces);
  }
  return places;
}

struct Found {
  int row = 0;
  int disparity = 0;
};

std::optional<Found> find(const Place& place, const GrayImage& left, const GrayImage& right,
                          int from, int to) {
  std::array<int, kSide * kSide> window{};
  int sum = 0;
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; j < kSide; ++j) {
      sum += window[kSide * i + j] = left(place.x - kReach + j, place.y - kReach + i);
    }
  }
  constexpr int n = kSide * kSide;
  int least = std::max(kLargestDifference * n, place.texture / 2);
  std::optional<Found> found;
  for (int row = -kFarthestRow; row <= kFarthestRow; ++row) {
    const int y = place.y + row;
    if (y < kReach || y + kReach >= right.height()) continue;
    for (int d = from; d <= to; ++d) {
      const int x = place.x - d;
      if (x < kReach || x + kReach >= right.width()) continue;
      int sum_right = 0;
      for (int i = -kReach; i <= kReach; ++i) {
        const std::uint8_t* R = right.row(y + i) + x;
        for (int j = -kReach; j <= kReach; ++j) sum_right += R[j];
      }
      const int offset = (sum - sum_right) / n;
      int difference = 0;
      for (int i = 0; i < kSide && difference < least; ++i) {
        const std::uint8_t* R = right.row(y - kReach + i) + x - kReach;
        const int* L = window.data() + kSide * i;
        for (int j = 0; j < kSide; ++j) difference += std::abs(L[j] - R[j] - offset);
      }
      if (difference >= least) continue;
      least = difference;
      found = Found{row, d};
    }
  }
  return found;
}

// The offset on which most points agree.
struct Agreement {
  double rows_px = 0;
  bool behind_infinity = false;  // most points have a disparity below that of infinity
};

std::optional<Agreement> agreement_of(const GrayImage& left, const GrayImage& right, int infinity,
                                      int reach) {
  PALPABLE_EXPECT(left.width() == right.width() && left.height() == right.height(),
                  "both eyes see images of one size");
  PALPABLE_EXPECT(reach >= 1, "disparities are searched");
  if (std::min(left.width(), left.height()) < 2 * kFarthestRow) return std::nullopt;
  std::vector<Found> places;
  for (const Place& place : textured_places(left)) {
    const auto found = find(place, left, right, infinity - reach, infinity + reach);
    if (found) places.push_back(*found);
  }
  if (places.size() < kLeastPlaces) return std::nullopt;
  // The row offset with the most points, counting those of the two neighbouring rows.
  std::array<int, 2 * kFarthestRow + 3> votes{};
  for (const Found& f : places) ++votes[f.row + kFarthestRow + 1];
  const auto near = [&](int row) {
    const int i = row + kFarthestRow + 1;
    return votes[i - 1] + votes[i] + votes[i + 1];
  };
  int best = -kFarthestRow;
  for (int row = best; row <= kFarthestRow; ++row) {
    if (near(row) > near(best)) best = row;
  }
  const double least = kAgreeing * static_cast<double>(places.size());
  if (near(best) < least) return std::nullopt;
  double rows = 0;
  int behind_infinity = 0;
  for (const Found& f : places) {
    if (std::abs(f.row - best) > 1) continue;
    rows += f.row;
    behind_infinity += f.disparity < infinity - 2 ? 1 : 0;
  }
  return Agreement{rows / near(best), behind_infinity >= least};
}

}  // namespace

std::optional<double> rows_between(const GrayImage& left, const GrayImage& right, int infinity,
                                   int reach) {
  const std::optional<Agreement> agreed = agreement_of(left, right, infinity, reach);
  if (!agreed || agreed->behind_infinity) return std::nullopt;
  return agreed->rows_px;
}

std::optional<PairMisfit> misfit_of(const GrayImage& left, const GrayImage& right, int infinity,
                                    int reach) {
  const std::optional<Agreement> agreed = agreement_of(left, right, infinity, reach);
  if (!agreed) return std::nullopt;
  const PairMisfit misfit{agreed->behind_infinity, agreed->rows_px};
  if (!misfit.swapped && std::abs(misfit.rows_px) < kLeastRowsOff) return std::nullopt;
  return misfit;
}

std::string PairMisfit::message() const {
  if (swapped) {
    return "left and right are swapped: near things lie further right in the right image; exchange "
           "the images";
  }
  return fmt::format(
      "the rows of the two eyes are {:.0f} px apart with this calibration; it is of another "
      "camera, "
      "or the camera was bent: give its own with --calibration, or make one with palpable "
      "calibrate",
      std::abs(rows_px));
}

}  // namespace palpable

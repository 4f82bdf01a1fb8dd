#include "palpable/live/stereo/disparity_filters.h"

#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace palpable {
namespace {

constexpr std::int16_t px(double d) { return static_cast<std::int16_t>(d * kDisparitySteps); }

// Patches of a few levels, some of them unknown or too close.
Disparities some_disparities(int width, int height, unsigned seed) {
  auto random = test::random_case(seed);
  Disparities d(width, height);
  for (std::int16_t& v : d) {
    const auto kind = random() % 12;
    v = kind == 0   ? kUnknownDisparity
        : kind == 1 ? kTooCloseDisparity
                    : static_cast<std::int16_t>(kind % 3 * 200 + random() % 80);
  }
  return d;
}

Winners winners_of(int width, int best, int cost) {
  Winners winners;
  winners.resize(width, 1);
  std::fill(winners.best.begin(), winners.best.end(), static_cast<std::uint16_t>(best));
  std::fill(winners.cost.begin(), winners.cost.end(), static_cast<std::uint8_t>(cost));
  std::fill(winners.before.begin(), winners.before.end(), static_cast<std::uint8_t>(cost + 12));
  std::fill(winners.after.begin(), winners.after.end(), static_cast<std::uint8_t>(cost + 12));
  return winners;
}

struct Checked {
  Disparities d;
  GrayImage confidence;
};

Checked check(const Winners& winners, int first, int disparities, int left_right) {
  Checked out{Disparities(winners.best.width(), 1), GrayImage(winners.best.width(), 1)};
  std::vector<std::uint32_t> owners;
  check_winners(winners, first, disparities, left_right, 0, 1, out.d, out.confidence, owners);
  return out;
}

TEST_CASE("a slope that comes out some rows too late is put back", "[stereo]") {
  constexpr int kWidth = 40, kHeight = 60;
  constexpr double kRows = kLagRows_64 / 64.0, kSlope = 0.15;  // px a row, a desk's
  Disparities late(kWidth, kHeight), back(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      // On the right there is a nearer object down to row 30, and one unknown pixel.
      late(x, y) = x < 30 ? px(20 + kSlope * (y - kRows)) : y < 30 ? px(40) : px(20);
    }
  }
  late(10, 20) = kUnknownDisparity;
  late(12, 20) = kTooCloseDisparity;
  take_lag_back(late, 0, 30, back);
  take_lag_back(late, 30, kHeight, back);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const bool as_it_is = x >= 30 || y < 2 || y + 2 >= kHeight || !is_measured(late(x, y)) ||
                            !is_measured(late(x, y - 2)) || !is_measured(late(x, y + 2));
      const int expected = as_it_is ? late(x, y) : px(20 + kSlope * y);
      CHECK(std::abs(back(x, y) - expected) <= (as_it_is ? 0 : 2));  // 1/64 px, rounded twice
    }
  }
}

TEST_CASE("a winner with its partner outside, or at an end of the range, is unknown", "[stereo]") {
  const Checked found = check(winners_of(40, 7, 3), 2, 16, 1);
  for (int x = 0; x < 40; ++x) {
    CHECK(found.d(x, 0) == (x < 9 ? kUnknownDisparity : px(9)));
    CHECK((found.confidence(x, 0) >= kLeastConfidence) == (x >= 9));
  }
  for (const int end : {0, 15}) {
    const Checked at_end = check(winners_of(40, end, 3), 2, 16, 1);
    CHECK(std::all_of(at_end.d.begin(), at_end.d.end(),
                      [](std::int16_t d) { return d == kUnknownDisparity; }));
  }
}

TEST_CASE("of two pixels that claim one partner the better one keeps it, of equals the nearer",
          "[stereo]") {
  Winners winners = winners_of(40, 5, 6);
  winners.best(30, 0) = 10;  // claims 20, as x = 25 does with 5
  winners.cost(30, 0) = 4;
  Checked found = check(winners, 0, 32, 1);
  CHECK(found.d(30, 0) == px(10));
  CHECK(found.d(25, 0) == kUnknownDisparity);
  winners.cost(30, 0) = 8;
  found = check(winners, 0, 32, 1);
  CHECK(found.d(30, 0) == kUnknownDisparity);
  CHECK(found.d(25, 0) == px(5));
  winners.cost(30, 0) = 6;
  found = check(winners, 0, 32, 1);
  CHECK(found.d(30, 0) == px(10));
  CHECK(found.d(25, 0) == kUnknownDisparity);
  CHECK(check(winners, 0, 32, 5).d(25, 0) == px(5));  // within the tolerance
}

TEST_CASE("the fraction of a pixel is the tip of two lines of equal slope", "[stereo]") {
  for (int before = 0; before <= 60; ++before) {
    for (int after = 0; after <= 60; ++after) {
      Winners winners = winners_of(20, 4, 5);
      winners.before(15, 0) = static_cast<std::uint8_t>(5 + before);
      winners.after(15, 0) = static_cast<std::uint8_t>(5 + after);
      const int steep = std::max(before, after);
      const double tip = steep == 0 ? 0 : 0.5 * (before - after) / steep;
      const double found = check(winners, 0, 16, 1).d(15, 0) / 64.0 - 4;
      CHECK(std::abs(found - tip) <= test::tolerance(0.5 / 64 + 1e-9, "rounded to 1/64 px"));
      CHECK(std::abs(found) <= 0.5);
    }
  }
}

TEST_CASE("the more the eyes agree, the surer", "[stereo]") {
  int last = 256;
  for (int cost = 0; cost < 80; cost += 8) {
    const int sure = check(winners_of(20, 4, cost), 0, 16, 1).confidence(15, 0);
    CHECK((sure < last || (cost > 72 && sure == last)));
    CHECK(sure >= kLeastConfidence);
    last = sure;
  }
}

TEST_CASE("the median of nine is the median, and unknown stays unknown", "[stereo]") {
  const Disparities in = some_disparities(37, 11, 1);
  Disparities out(37, 11);
  median_3x3(in, 0, 4, out);
  median_3x3(in, 4, 11, out);
  for (int y = 0; y < 11; ++y) {
    for (int x = 0; x < 37; ++x) {
      const bool border = x == 0 || y == 0 || x == 36 || y == 10;
      if (border || !is_measured(in(x, y))) {
        CHECK(out(x, y) == in(x, y));
        continue;
      }
      std::vector<std::int16_t> nine;
      for (int v = y - 1; v <= y + 1; ++v) {
        for (int u = x - 1; u <= x + 1; ++u) {
          nine.push_back(is_measured(in(u, v)) ? in(u, v) : in(x, y));
        }
      }
      std::sort(nine.begin(), nine.end());
      CHECK(out(x, y) == nine[4]);
    }
  }
}

TEST_CASE("smoothing is the mean of the neighbours on the same surface", "[stereo]") {
  // Wider than a chunk of columns, with values up to the largest possible.
  for (const int offset : {-20000, 0, kMostDisparities * kDisparitySteps - 600}) {
    Disparities in = some_disparities(150, 9, 2);
    for (std::int16_t& d : in) {
      if (is_measured(d)) d = static_cast<std::int16_t>(d + offset);
    }
    Disparities out(150, 9);
    smooth_surfaces(in, 0, 5, out);
    smooth_surfaces(in, 5, 9, out);
    for (int y = 0; y < 9; ++y) {
      for (int x = 0; x < 150; ++x) {
        if (!is_measured(in(x, y))) {
          CHECK(out(x, y) == in(x, y));
          continue;
        }
        double sum = 0;
        int n = 0;
        for (int v = std::max(y - 2, 0); v <= std::min(y + 2, 8); ++v) {
          for (int u = std::max(x - 2, 0); u <= std::min(x + 2, 149); ++u) {
            if (!is_measured(in(u, v)) || std::abs(in(u, v) - in(x, y)) > kSmoothStep) continue;
            sum += in(u, v);
            ++n;
          }
        }
        CHECK(std::abs(out(x, y) - sum / n) <= test::tolerance(0.5 + 1e-9, "rounded to a step"));
      }
    }
  }
}

TEST_CASE("speckles are those of cv::filterSpeckles", "[stereo]") {
  SpeckleFilter filter;
  for (unsigned seed = 0; seed < 20; ++seed) {
    INFO("seed " << seed);
    Disparities d = some_disparities(64, 33, seed);
    for (std::int16_t& v : d) {
      if (v == kTooCloseDisparity) v = kUnknownDisparity;  // OpenCV has only one mark
    }
    cv::Mat reference(33, 64, CV_16SC1);
    std::copy(d.begin(), d.end(), reference.begin<std::int16_t>());
    const int size = 3 + static_cast<int>(seed);
    cv::filterSpeckles(reference, kUnknownDisparity, size - 1, 64);
    filter({size, 0}, 64, GrayImage(64, 33, 200), d);
    CHECK(std::equal(d.begin(), d.end(), reference.begin<std::int16_t>()));
  }
}

TEST_CASE("a larger patch is noise only if the eyes hardly agree on it", "[stereo]") {
  SpeckleFilter filter;
  for (const int sure : {100, 200}) {
    Disparities d(60, 30, kUnknownDisparity);
    for (int y = 5; y < 15; ++y) std::fill_n(d.row(y) + 10, 12, px(20));  // 120 px
    filter({50, 500, 160}, 64, GrayImage(60, 30, static_cast<std::uint8_t>(sure)), d);
    CHECK(is_measured(d(12, 7)) == (sure == 200));
    // Patches larger than doubtful_size are kept in any case.
    Disparities wall(60, 30, px(20));
    filter({50, 500, 160}, 64, GrayImage(60, 30, static_cast<std::uint8_t>(sure)), wall);
    CHECK(is_measured(wall(0, 0)));
  }
}

TEST_CASE("gaps are filled along a surface, and at an edge only if asked, with the far side",
          "[stereo]") {
  const auto row = [](std::initializer_list<double> values) {
    Disparities d(static_cast<int>(values.size()), 1);
    std::transform(values.begin(), values.end(), d.begin(),
                   [](double v) { return std::isnan(v) ? kUnknownDisparity : px(v); });
    return d;
  };
  const double hole = std::nan("");
  for (const bool edges : {false, true}) {
    Disparities d =
        row({hole, 10, hole, hole, hole, 11, 30, hole, 12, hole, hole, hole, hole, 12, hole});
    GrayImage sure(15, 1, 200);
    fill_gaps(3, px(1.5), edges, 0, 1, d, sure);
    CHECK(d == row({hole, 10, 10.25, 10.5, 10.75, 11, 30, edges ? 12 : hole, 12, hole, hole, hole,
                    hole, 12, hole}));
    CHECK(sure(3, 0) == kFilledConfidence);
    CHECK(sure(1, 0) == 200);
  }
  // Gaps beside pixels that are too close are not filled.
  Disparities d = row({10, hole, 10});
  d(2, 0) = kTooCloseDisparity;
  GrayImage sure(3, 1);
  fill_gaps(3, px(1.5), true, 0, 1, d, sure);
  CHECK(d(1, 0) == kUnknownDisparity);
}

TEST_CASE("speckles take memory once", "[stereo]") {
  SpeckleFilter filter;
  const GrayImage sure(64, 48, 200);
  Disparities d = some_disparities(64, 48, 1);
  filter({3, 0}, 64, sure, d);
  Disparities next = some_disparities(64, 48, 2);
  CHECK(test::allocations_during([&] { filter({3, 0}, 64, sure, next); }) == 0);
}

}  // namespace
}  // namespace palpable

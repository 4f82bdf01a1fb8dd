#include "palpable/live/stereo/stereo_matcher.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/order_statistics.h"
#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace palpable {
namespace {

// Brightness that is smooth at the scale of one pixel along a row and of three rows across; `u` may
// be any real number.
class Rows {
 public:
  Rows(int height, unsigned seed) : lattice_(static_cast<std::size_t>(kPeriod * height)) {
    auto random = test::random_case(seed);
    for (double& v : lattice_) v = std::uniform_real_distribution<double>(40, 210)(random);
  }
  [[nodiscard]] double at(double u, int y) const {
    const double t = y % 3 / 3.0;
    return (1 - t) * along(u, y / 3) + t * along(u, y / 3 + 1);
  }

 private:
  static constexpr int kPeriod = 1024;
  [[nodiscard]] double along(double u, int row) const {
    const double wide = u / 2.5;
    const int i = static_cast<int>(std::floor(wide));
    const double t = (1 - std::cos((wide - i) * M_PI)) / 2;
    return (1 - t) * value(i, row) + t * value(i + 1, row);
  }
  [[nodiscard]] double value(int i, int y) const {
    return lattice_[(i & (kPeriod - 1)) + kPeriod * y];
  }
  std::vector<double> lattice_;
};

struct Pair {
  GrayImage left;
  GrayImage right;
};

// The left eye sees the texture at u, the right one the same at u - disparity(y). Each row has a
// constant disparity, so that the truth is known without rendering.
template <class Disparity>
Pair seen_by_both(int width, int height, unsigned seed, const Disparity& disparity) {
  const Rows rows(height, seed);
  auto random = test::random_case(seed + 100);
  std::normal_distribution<double> noise(0, 0.5);
  Pair pair{GrayImage(width, height), GrayImage(width, height)};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto byte = [&](double v) {
        return static_cast<std::uint8_t>(std::clamp(std::lround(v + noise(random)), 0L, 255L));
      };
      pair.left(x, y) = byte(rows.at(x, y));
      pair.right(x, y) = byte(rows.at(x + disparity(y), y));
    }
  }
  return pair;
}

double share_within(const MatchedPair& pair, int from_column, double truth, double limit) {
  int good = 0;
  int all = 0;
  for (int y = 0; y < pair.disparity.height(); ++y) {
    for (int x = from_column; x < pair.disparity.width(); ++x) {
      const std::int16_t d = pair.disparity(x, y);
      ++all;
      good += is_measured(d) && std::abs(d / 64.0 - truth) <= limit ? 1 : 0;
    }
  }
  return static_cast<double>(good) / all;
}

StereoMatcherSettings small_matching() {
  StereoMatcherSettings settings = near_matching();
  settings.disparities = 48;
  settings.guard_disparities = 32;
  return settings;
}

TEST_CASE("a plane at a fraction of a pixel is found there, negative disparities too", "[stereo]") {
  for (const double truth : {20.3, 11.75, -4.6}) {
    INFO("disparity " << truth);
    const Pair pair = seen_by_both(160, 72, 1, [&](int) { return truth; });
    StereoMatcherSettings settings = small_matching();
    settings.first = truth < 0 ? -12 : 1;
    StereoMatcher matcher(settings);
    MatchedPair found;
    matcher.match(pair.left, pair.right, found);
    CHECK(share_within(found, 30, truth, 0.3) >=
          test::tolerance(0.9, "noise of half a grey level; borders"));
  }
}

GrayImage half_of(const GrayImage& image) {
  GrayImage half(image.width() / 2, image.height() / 2);
  for (int y = 0; y < half.height(); ++y) {
    for (int x = 0; x < half.width(); ++x) {
      half(x, y) =
          static_cast<std::uint8_t>((image(2 * x, 2 * y) + image(2 * x + 1, 2 * y) +
                                     image(2 * x, 2 * y + 1) + image(2 * x + 1, 2 * y + 1) + 2) /
                                    4);
    }
  }
  return half;
}

TEST_CASE("refining at full resolution brings the disparity within a twentieth of a pixel",
          "[stereo]") {
  const double truth = 27.36;  // full px
  const Pair full = seen_by_both(321, 145, 2, [&](int) { return truth; });
  StereoMatcher matcher(small_matching());
  MatchedPair found;
  matcher.match(half_of(full.left), half_of(full.right), found);
  const double before = share_within(found, 30, truth / 2, 0.025);
  matcher.refine(full.left, full.right, found);
  const double after = share_within(found, 30, truth / 2, 0.025);
  INFO("within 0.05 px before: " << before << ", after: " << after);
  CHECK(after >= test::tolerance(0.85, "noise of half a grey level; borders"));
  CHECK(after > before);
}

// Weak texture as on skin or wood, with a sensor's noise.
void fade(GrayImage& image, unsigned seed) {
  auto random = test::random_case(seed);
  std::normal_distribution<double> noise(0, 1);
  for (std::uint8_t& v : image) {
    v = static_cast<std::uint8_t>(std::lround(125 + 0.03 * (v - 125) + noise(random)));
  }
}

TEST_CASE("a desk that slopes away comes out where it is, not some rows later", "[stereo]") {
  constexpr double kSlope = 0.2;                                    // px a row
  const auto truth = [](double row) { return 20 + kSlope * row; };  // full px
  Pair full = seen_by_both(321, 145, 2, [&](int y) { return truth(y); });
  fade(full.left, 1);
  fade(full.right, 2);
  StereoMatcher matcher(small_matching());
  MatchedPair found;
  matcher.match(half_of(full.left), half_of(full.right), found);
  matcher.refine(full.left, full.right, found);
  std::vector<double> off;
  for (int y = 4; y + 4 < found.disparity.height(); ++y) {
    for (int x = 40; x < found.disparity.width(); ++x) {
      const std::int16_t d = found.disparity(x, y);
      if (is_measured(d)) off.push_back(d / 64.0 - truth(2 * y + 0.5) / 2);
    }
  }
  REQUIRE(off.size() > 3000);
  CHECK(std::abs(upper_median(off)) <
        test::tolerance(0.03, "px; 0.09 if the lag is not taken back"));
}

TEST_CASE("what is nearer than the range is called too close or unknown, not far", "[stereo]") {
  // The background is at 8 px; the lower half is at 80 px, beyond the 48 px that are searched.
  const auto disparity = [](int y) { return y < 48 ? 8.0 : 80.0; };
  const Pair pair = seen_by_both(256, 96, 3, disparity);
  StereoMatcherSettings settings = small_matching();
  const auto count = [&](bool guarded) {
    settings.guard_disparities = guarded ? 32 : 0;
    StereoMatcher matcher(settings);
    MatchedPair found;
    matcher.match(pair.left, pair.right, found);
    struct {
      int too_close = 0, far = 0, background = 0;
    } n;
    for (int y = 0; y < 96; ++y) {
      for (int x = 100; x < 256; ++x) {
        const std::int16_t d = found.disparity(x, y);
        if (y >= 56) {
          n.too_close += d == kTooCloseDisparity ? 1 : 0;
          n.far += is_measured(d) ? 1 : 0;
        } else if (y < 40) {
          n.background += is_measured(d) && std::abs(d / 64.0 - 8) < 0.5 ? 1 : 0;
        }
        if (!is_measured(d)) CHECK(found.confidence(x, y) == 0);
      }
    }
    return n;
  };
  const auto guarded = count(true);
  const int lower = 40 * 156;
  CHECK(guarded.too_close >= lower / 2);
  CHECK(guarded.far <= lower / 1000);
  CHECK(guarded.background >= 40 * 156 * 9 / 10);
  CHECK(count(false).too_close == 0);
}

TEST_CASE("disparities are the same on one thread and on four, on all instruction sets",
          "[stereo][threads]") {
  const Pair pair = seen_by_both(150, 70, 4, [](int y) { return 10 + 0.1 * y; });
  const Pair full = seen_by_both(300, 140, 5, [](int y) { return 20 + 0.1 * y; });
  MatchedPair reference;
  for (const StereoKernels& kernels : stereo_kernels()) {
    for (const int threads : {1, 2, 4}) {
      INFO(kernels.name << " on " << threads);
      StereoMatcherSettings settings = small_matching();
      settings.threads = threads;
      settings.kernels = &kernels;
      StereoMatcher matcher(settings);
      MatchedPair found;
      matcher.match(pair.left, pair.right, found);
      matcher.refine(full.left, full.right, found);
      if (reference.disparity.empty()) reference = found;
      CHECK(found.disparity == reference.disparity);
      CHECK(found.confidence == reference.confidence);
    }
  }
}

TEST_CASE("from the second pair on, matching takes no memory", "[stereo]") {
  const Pair pair = seen_by_both(150, 70, 6, [](int) { return 12.0; });
  const Pair full = seen_by_both(300, 140, 7, [](int) { return 24.0; });
  StereoMatcherSettings settings = small_matching();
  StereoMatcher matcher(settings);
  MatchedPair found;
  const auto frame = [&] {
    matcher.match(pair.left, pair.right, found);
    matcher.refine(full.left, full.right, found);
  };
  frame();
  CHECK(test::allocations_during(frame) == 0);
}

TEST_CASE("bright and dark eyes agree as well as equal ones", "[stereo]") {
  Pair pair = seen_by_both(160, 72, 8, [](int) { return 15.0; });
  for (std::uint8_t& p : pair.right) p = static_cast<std::uint8_t>(p * 7 / 10);
  StereoMatcher matcher(small_matching());
  MatchedPair found;
  matcher.match(pair.left, pair.right, found);
  CHECK(share_within(found, 30, 15.0, 0.5) >= 0.9);
}

TEST_CASE("settings that do not fit 16 bits, and images of two sizes, are refused",
          "[stereo][refusal]") {
  const auto refused = [](auto change) {
    StereoMatcherSettings settings = small_matching();
    change(settings);
    CHECK_THROWS_AS(StereoMatcher(settings), ContractViolation);
  };
  refused([](auto& s) { s.penalties.p1 = s.penalties.p2_least + 1; });
  refused([](auto& s) { s.penalties.p2_least = s.penalties.p2 + 1; });
  refused([](auto& s) { s.penalties.p1 = -1; });
  refused([](auto& s) { s.penalties.p2 = kLargestP2 + 1; });
  refused([](auto& s) { s.disparities = 0; });
  refused([](auto& s) { s.disparities = kMostDisparities; });
  refused([](auto& s) { s.first = -kMostDisparities; });
  refused([](auto& s) { s.guard_disparities = -1; });
  refused([](auto& s) { s.threads = 0; });
  StereoMatcher matcher(small_matching());
  MatchedPair found;
  CHECK_THROWS_AS(matcher.match(GrayImage(40, 40), GrayImage(40, 41), found), ContractViolation);
  CHECK_THROWS_AS(matcher.match(GrayImage(15, 40), GrayImage(15, 40), found), ContractViolation);
  matcher.match(GrayImage(40, 40), GrayImage(40, 40), found);
  CHECK_THROWS_AS(matcher.refine(GrayImage(90, 80), GrayImage(90, 80), found), ContractViolation);
}

}  // namespace
}  // namespace palpable

#include "palpable/live/stereo/stereo_kernels.h"

#include "tests/support/noisy_pair.h"
#include "tests/support/test.h"

#include <algorithm>
#include <memory>
#include <random>
#include <string>
#include <vector>

namespace palpable {
namespace {

using test::noisy_pair;
using test::NoisyPair;

class Workspace {
 public:
  Workspace(int width, int disparities) : bytes_(kernel_workspace_bytes(width, disparities) + 64) {
    void* at = bytes_.data();
    std::size_t room = bytes_.size();
    begin_ = static_cast<std::uint8_t*>(std::align(64, bytes_.size() - 64, at, room));
  }
  [[nodiscard]] std::uint8_t* begin() const { return begin_; }

 private:
  std::vector<std::uint8_t> bytes_;
  std::uint8_t* begin_ = nullptr;
};

struct Found {
  CensusCodes left;
  CensusCodes right;
  Winners winners;
};

Found run(const StereoKernels& kernels, const NoisyPair& pair, int first, int disparities,
          const PathPenalties& penalties, int strips_at_once) {
  const int width = pair.left.width();
  const int height = pair.left.height();
  Found found;
  for (CensusCodes* codes : {&found.left, &found.right}) {
    for (GrayImage& plane : *codes) plane.resize(width, height);
  }
  found.winners.resize(width, height);
  const Workspace workspace(width, disparities);
  kernels.census(pair.left, found.left, workspace.begin());
  kernels.census(pair.right, found.right, workspace.begin());
  const MatchJob job{&found.left, &found.right, &pair.left,    first,
                     disparities, penalties,    &found.winners};
  for (int strip = 0; strip < kStrips; strip += strips_at_once) {
    kernels.match(job, strip, strips_at_once, workspace.begin());
  }
  return found;
}

TEST_CASE("all instruction sets give the winners of the plain loops, bit for bit", "[stereo]") {
  struct Case {
    int width, height, first, disparities;
    PathPenalties penalties;
  };
  unsigned seed = 0;
  for (const Case& c : {Case{203, 75, 0, 48, {3, 40, 6}}, Case{64, 41, -3, 16, {5, 40, 40}},
                        Case{131, 67, 12, 256, {10, 61, 20}}, Case{90, 4, 0, 32, {0, 0, 0}},
                        Case{33, 20, -20, 304, {3, 45, 3}}}) {
    const NoisyPair pair = noisy_pair(c.width, c.height, seed++);
    const Found plain =
        run(scalar_stereo_kernels(), pair, c.first, c.disparities, c.penalties, kStrips);
    for (const StereoKernels& kernels : stereo_kernels()) {
      for (const int at_once : {4, 2, 1}) {
        INFO(kernels.name << ", " << at_once << " strips at once, width " << c.width << ", "
                          << c.disparities << " disparities");
        const Found found = run(kernels, pair, c.first, c.disparities, c.penalties, at_once);
        CHECK(found.left == plain.left);
        CHECK(found.right == plain.right);
        CHECK(found.winners.best == plain.winners.best);
        CHECK(found.winners.cost == plain.winners.cost);
        CHECK(found.winners.before == plain.winners.before);
        CHECK(found.winners.after == plain.winners.after);
      }
    }
  }
}

TEST_CASE("the plain loops are always there, and this processor has more", "[stereo]") {
  const auto kernels = stereo_kernels();
  REQUIRE_FALSE(kernels.empty());
  CHECK(std::string(kernels.back().name) == "scalar");
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx2")) {
    CHECK(std::any_of(kernels.begin(), kernels.end(),
                      [](const StereoKernels& k) { return std::string(k.name) == "AVX2"; }));
    CHECK(std::string(kernels.front().name) != "scalar");
  }
#endif
}

TEST_CASE("a census code is the same at another exposure", "[stereo]") {
  NoisyPair pair{GrayImage(40, 12), GrayImage(40, 12)};
  auto random = test::random_case(3);
  for (std::uint8_t& p : pair.left) p = static_cast<std::uint8_t>(random() % 30 * 4 + 20);
  std::transform(pair.left.begin(), pair.left.end(), pair.right.begin(),
                 [](std::uint8_t p) { return static_cast<std::uint8_t>(p * 3 / 2 + 9); });
  const Found found = run(scalar_stereo_kernels(), pair, 0, 16, {3, 40, 6}, kStrips);
  CHECK(found.left == found.right);
}

TEST_CASE("a picture that is shifted is found at its shift, at no cost", "[stereo]") {
  const int width = 120;
  const int shift = 23;
  NoisyPair pair{GrayImage(width, 40), GrayImage(width, 40)};
  auto random = test::random_case(5);
  std::vector<std::uint8_t> row(width + shift);
  for (int y = 0; y < 40; ++y) {
    for (std::uint8_t& p : row) p = static_cast<std::uint8_t>(random() % 200);
    std::copy_n(row.begin(), width, pair.left.row(y));
    std::copy_n(row.begin() + shift, width, pair.right.row(y));
  }
  const Found found = run(stereo_kernels().front(), pair, 4, 32, {3, 40, 6}, kStrips);
  for (int y = 2; y < 38; ++y) {
    // Pixels whose partner lies outside have a cost that affects the path from the left for some
    // more pixels; at the right border windows are cut off.
    for (int x = 2 * shift; x < width - 3; ++x) {
      REQUIRE(found.winners.best(x, y) + 4 == shift);
      REQUIRE(found.winners.cost(x, y) == 0);
    }
  }
}

TEST_CASE("where the picture has an edge disparities jump, where it has none they may ramp",
          "[stereo]") {
  // An object 9 px nearer than its background, both with little texture: nine steps of P1 = 3 cost
  // less than a jump with P2 = 40.
  const int width = 200;
  const int height = 64;
  const int edge = 120;
  const int background = 8;
  const int foreground = 17;
  const auto on_the_ramp = [&](int brighter, int p2_least) {
    NoisyPair pair{GrayImage(width, height), GrayImage(width, height)};
    auto random = test::random_case(6);
    std::vector<int> near_row(width + 64), far_row(width + 64);
    for (int y = 0; y < height; ++y) {
      for (int& v : near_row) v = 100 + brighter + static_cast<int>(random() % 5);
      for (int& v : far_row) v = 100 + static_cast<int>(random() % 5);
      for (int x = 0; x < width; ++x) {
        const auto seen = [&](int near_u, int far_u) {
          return static_cast<std::uint8_t>(near_u >= edge ? near_row[near_u] : far_row[far_u]);
        };
        pair.left(x, y) = seen(x, x);
        pair.right(x, y) = seen(x + foreground, x + background);
      }
    }
    const Found found = run(stereo_kernels().front(), pair, 0, 32, {3, 40, p2_least}, kStrips);
    int count = 0;
    for (int y = 2; y + 2 < height; ++y) {
      for (int x = edge - 30; x < edge + 20; ++x) {
        const int d = found.winners.best(x, y);
        count += d > background + 1 && d < foreground - 1 ? 1 : 0;
      }
    }
    return count;
  };
  const int falling = on_the_ramp(60, 6);
  const int constant = on_the_ramp(60, 40);
  INFO(falling << " pixels between the two with P2 that falls, " << constant << " with one P2");
  // Some remain, because pixels that only the left eye sees have no true partner.
  CHECK(4 * falling < 3 * constant);
  CHECK(on_the_ramp(0, 6) > falling);
}

TEST_CASE("strips cover every row once", "[stereo]") {
  for (int height = 1; height < 40; ++height) {
    int next = 0;
    for (int strip = 0; strip < kStrips; ++strip) {
      CHECK(rows_of_strip(strip, height).begin == next);
      next = rows_of_strip(strip, height).end;
    }
    CHECK(next == height);
  }
}

}  // namespace
}  // namespace palpable

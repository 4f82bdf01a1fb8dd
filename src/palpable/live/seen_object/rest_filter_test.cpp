#include "palpable/live/seen_object/rest_filter.h"

#include "palpable/common/base/contract.h"
#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <cmath>
#include <limits>
#include <random>

namespace palpable {
namespace {

using test::tolerance;

constexpr PinholeCamera kCamera{160, 120, 350, 350, 80, 60};
constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
constexpr float kWall = 0.8f;
constexpr double kNoise = 0.01;  // m at 1 m

constexpr float kScatter = 0.0012f;  // m

// A slab of 30 x 60 pixels before a wall.
struct Slab {
  int x = 60, y = 30;
  float z = 0.4f;
  DepthImage depth{kCamera.width, kCamera.height, kWall};
  MaskImage shows{kCamera.width, kCamera.height, kShowsRoom};
  PixelBox box;

  // @param scatter  m, standard deviation of each pixel's depth
  void paint(std::mt19937_64& random, float scatter) {
    std::normal_distribution<float> normal;
    std::fill(depth.begin(), depth.end(), kWall);
    std::fill(shows.begin(), shows.end(), kShowsRoom);
    box = {x, y, 30, 60};
    for (int v = y; v < y + 60; ++v) {
      for (int u = x; u < x + 30; ++u) {
        depth(u, v) = z + scatter * normal(random);
        shows(u, v) = kShowsPresser;
      }
    }
  }
  void add_to(RestFilter& filter, const Rigid3& camera_from_body = Rigid3::Identity()) const {
    filter.add(depth, shows, box, kCamera, camera_from_body, kNoise);
  }
  void rest(int frames, std::mt19937_64& random, RestFilter& filter) {
    for (int frame = 0; frame < frames; ++frame) {
      paint(random, kScatter);
      add_to(filter);
    }
  }
  // rms of the filtered depth about z
  [[nodiscard]] double error_in(const RestFilter& filter) const {
    double sum = 0;
    for (int v = y; v < y + 60; ++v) {
      for (int u = x; u < x + 30; ++u) {
        const double e = static_cast<double>(filter.depth()(u, v) - z);
        sum += e * e;
      }
    }
    return std::sqrt(sum / 1800);
  }
};

TEST_CASE("a resting thing is averaged over 32 frames", "[seen_object][rest]") {
  auto random = test::random_case(1);
  RestFilter filter;
  Slab slab;
  slab.paint(random, kScatter);
  slab.add_to(filter);
  CHECK(filter.frames_at(75, 60) == 1);
  CHECK(slab.error_in(filter) == Approx(kScatter).epsilon(0.1));
  slab.rest(99, random, filter);
  CHECK(filter.frames_at(75, 60) == Approx(32));
  // With a weight of 1/32 for each new frame the variance is 1/63 of one frame's.
  CHECK(slab.error_in(filter) ==
        Approx(static_cast<double>(kScatter) / std::sqrt(63.0)).epsilon(0.15));
}

TEST_CASE("a moving thing is shown as in the present frame alone", "[seen_object][rest]") {
  auto random = test::random_case(2);
  RestFilter filter;
  Slab slab;
  slab.rest(40, random, filter);
  // 0.5 m/s at 30 Hz towards the camera, then as fast across the picture.
  const auto is_the_frame = [&] {
    slab.paint(random, kScatter);
    slab.add_to(filter);
    for (int v = 0; v < kCamera.height; ++v) {
      for (int u = 0; u < kCamera.width; ++u) {
        const bool thing = slab.shows(u, v) == kShowsPresser;
        if ((filter.shows()(u, v) == kShowsPresser) != thing) return false;
        if (thing && filter.depth()(u, v) != slab.depth(u, v)) return false;
      }
    }
    return true;
  };
  for (int frame = 0; frame < 4; ++frame) {
    slab.z -= 0.5f / 30;
    CHECK(is_the_frame());
  }
  slab.rest(20, random, filter);
  for (int frame = 0; frame < 3; ++frame) {
    slab.x += 17;
    CHECK(is_the_frame());
  }
}

TEST_CASE("the average of a creeping thing lags by less than the setting flows",
          "[seen_object][rest]") {
  auto random = test::random_case(3);
  RestFilter filter;
  Slab slab;
  slab.rest(40, random, filter);
  for (int frame = 0; frame < 100; ++frame) {
    slab.z -= 0.0003f;  // 9 mm/s
    slab.paint(random, kScatter);
    slab.add_to(filter);
    double late = 0;
    for (int v = 30; v < 90; ++v) {
      for (int u = 60; u < 90; ++u) late += static_cast<double>(filter.depth()(u, v) - slab.z);
    }
    CHECK(std::abs(late / 1800) < RestFilterSettings{}.flows);
  }
  // Across the picture by half a pixel per frame: one pixel (1.1 mm) in every other frame.
  slab.rest(40, random, filter);
  for (int frame = 0; frame < 60; ++frame) {
    if (frame % 2 == 0) slab.x += 1;
    slab.paint(random, kScatter);
    slab.add_to(filter);
    int covered = 0;
    for (int u = 0; u < kCamera.width; ++u) covered += filter.shows()(u, 60) == kShowsPresser;
    CHECK(covered == 30);
    CHECK(filter.shows()(slab.x + 29, 60) == kShowsPresser);
  }
}

TEST_CASE("a flickering outline comes to rest within its pixels", "[seen_object][rest]") {
  auto random = test::random_case(4);
  RestFilter filter;
  Slab slab;
  double mean = 0;
  for (int frame = 0; frame < 200; ++frame) {
    slab.paint(random, 0);
    // The column beside the slab shows the slab in three of ten frames, in varying rows.
    slab.box.width = 31;
    for (int v = 30; v < 90; ++v) {
      if ((frame + 3 * v) % 10 >= 3) continue;
      slab.depth(90, v) = slab.z;
      slab.shows(90, v) = kShowsPresser;
    }
    slab.add_to(filter);
    if (frame >= 150) mean += static_cast<double>(filter.presence()(90, 60)) / 50;
  }
  CHECK(mean == Approx(0.3).margin(tolerance(0.03, "50 frames of a mean over 32")));
  CHECK(filter.presence()(89, 60) == Approx(1).margin(1e-4));
  CHECK(filter.shows()(90, 60) == kShowsRoom);
}

TEST_CASE("the presence at an outline is the mean share of the pixel that the thing covers",
          "[seen_object][rest]") {
  auto random = test::random_case(7);
  RestFilter filter;
  Slab slab;
  Image<float> coverage(kCamera.width, kCamera.height);
  for (int frame = 0; frame < 100; ++frame) {
    slab.paint(random, kScatter);
    slab.box.width += 2;
    for (std::size_t i = 0; i < coverage.size(); ++i) {
      coverage.data()[i] = slab.shows.data()[i] == kShowsPresser ? 1.0f : 0.0f;
    }
    // The outline crosses the column beside the slab, now here, now there.
    for (int v = slab.y; v < slab.y + 60; ++v)
      coverage(slab.x + 30, v) = frame % 2 == 0 ? 0.2f : 0.4f;
    filter.add(slab.depth, slab.shows, slab.box, kCamera, Rigid3::Identity(), kNoise, &coverage);
  }
  CHECK(filter.presence()(75, 60) == Approx(1));
  CHECK(filter.presence()(90, 60) ==
        Approx(0.3).margin(tolerance(0.01, "each frame has a weight of 1/32")));
  CHECK(filter.shows()(90, 60) == kShowsRoom);
  CHECK(filter.presence()(92, 60) == 0);
}

TEST_CASE("a hole without depth does not remove a resting thing", "[seen_object][rest]") {
  auto random = test::random_case(5);
  RestFilter filter;
  Slab slab;
  slab.rest(40, random, filter);
  slab.paint(random, kScatter);
  for (int v = 50; v < 60; ++v) {
    for (int u = 70; u < 80; ++u) {
      slab.depth(u, v) = kNone;
      slab.shows(u, v) = kShowsUnknown;
    }
  }
  slab.add_to(filter);
  CHECK(filter.shows()(75, 55) == kShowsPresser);
  CHECK(std::abs(static_cast<double>(filter.depth()(75, 55) - slab.z)) < 0.001);
}

TEST_CASE("a thing that left is forgotten at once", "[seen_object][rest]") {
  auto random = test::random_case(6);
  RestFilter filter;
  Slab slab;
  slab.rest(40, random, filter);
  std::fill(slab.depth.begin(), slab.depth.end(), kWall);
  std::fill(slab.shows.begin(), slab.shows.end(), kShowsRoom);
  slab.box = {};
  slab.add_to(filter);
  for (const std::uint8_t what : filter.shows()) REQUIRE(what != kShowsPresser);
}

TEST_CASE("the frames of a moving camera are passed on unchanged", "[seen_object][rest]") {
  auto random = test::random_case(7);
  RestFilter filter;
  Slab slab;
  Rigid3 camera_from_body = Rigid3::Identity();
  for (int frame = 0; frame < 10; ++frame) {
    slab.paint(random, kScatter);
    camera_from_body.translation().x() += 1e-4;
    slab.add_to(filter, camera_from_body);
  }
  CHECK(filter.depth()(75, 60) == slab.depth(75, 60));
  CHECK(filter.frames_at(75, 60) == 1);
}

TEST_CASE("the filter allocates nothing after the first frame, and refuses odd settings",
          "[seen_object][rest][frame loop]") {
  auto random = test::random_case(8);
  RestFilter filter;
  Slab slab;
  slab.paint(random, kScatter);
  slab.add_to(filter);
  CHECK(test::allocations_during([&] { slab.add_to(filter); }) == 0);
  CHECK_THROWS_AS(RestFilter({.rests = 0.002, .moves = 0.002}), ContractViolation);
  CHECK_THROWS_AS(RestFilter({.rests = -0.1}), ContractViolation);
  CHECK_THROWS_AS(RestFilter({.most_frames = 0}), ContractViolation);
  CHECK_THROWS_AS(RestFilter({.cell_px = 0}), ContractViolation);
  CHECK_THROWS_AS(RestFilter({.sigmas = 0}), ContractViolation);
}

}  // namespace
}  // namespace palpable

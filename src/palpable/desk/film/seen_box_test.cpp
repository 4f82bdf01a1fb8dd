#include "palpable/desk/film/seen_box.h"

#include "palpable/common/geometry/capsule.h"
#include "palpable/desk/film/tiles.h"
#include "palpable/desk/script/random.h"
#include "tests/support/test.h"

#include <algorithm>
#include <array>
#include <cmath>

using namespace palpable;

namespace {
const PinholeCamera kView{160, 90, 70, 75, 81.3, 43.9};

bool holds(const PixelBox& box, int x, int y) {
  return x >= box.x && x < box.x + box.width && y >= box.y && y < box.y + box.height;
}

/// Whether the ray of a pixel meets the capsule beyond the near plane.
bool is_seen(const Capsule& capsule, int x, int y) {
  const Eigen::Vector3d from = kView.unproject(x, y, SeenBox::kNearest);
  const std::array<Capsule, 1> one = {capsule};
  return std::isfinite(ray_distance(one, from, from.normalized(), 3.0));
}
}  // namespace

TEST_CASE("the visible part of a capsule lies in its box, also if the near plane cuts it",
          "[film]") {
  int seen = 0, cut = 0, cut_and_seen = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    INFO("seed " << seed);
    Random random(seed, "capsules");
    const auto point = [&] {
      return Eigen::Vector3d(random.between(-0.4, 0.4), random.between(-0.3, 0.3),
                             random.between(-0.2, 0.5));
    };
    Capsule capsule{point(), point(), random.between(0.005, 0.06), random.between(0.005, 0.06)};
    SeenBox box(kView);
    box.include(capsule.a, capsule.ra, capsule.b, capsule.rb);
    const PixelBox pixels = box.pixels();
    const bool is_cut =
        std::min(capsule.a.z() - capsule.ra, capsule.b.z() - capsule.rb) < SeenBox::kNearest;
    bool any = false, outside = false;
    for (int y = 0; y < kView.height; ++y)
      for (int x = 0; x < kView.width; ++x)
        if (is_seen(capsule, x, y)) {
          any = true;
          outside = outside || !holds(pixels, x, y);
        }
    CHECK_FALSE(outside);
    seen += any ? 1 : 0;
    cut += is_cut ? 1 : 0;
    cut_and_seen += any && is_cut ? 1 : 0;
  }
  CHECK(seen > 100);
  CHECK(cut_and_seen > 30);
  CHECK(cut > cut_and_seen);
}

TEST_CASE("the box of an arm that comes from behind the eye ends where the arm does", "[film]") {
  SeenBox box(kView);
  box.include({0.05, 0.02, 0.25}, 0.02, {0.3, 0.1, -0.2}, 0.05);
  const PixelBox pixels = box.pixels();
  const double left = kView.project({0.05, 0.02, 0.25}).x() - kView.fx_px * 0.02 / 0.25;
  CHECK(pixels.x < left);
  CHECK(pixels.x > left - 6.0);  // rounding, and the bounding square of a circle
  CHECK(pixels.x + pixels.width == kView.width);
}

TEST_CASE("the box of what is behind the eye or beside the picture is empty", "[film]") {
  SeenBox box(kView);
  CHECK(box.pixels().empty());
  box.include({0.0, 0.0, -0.10}, 0.05, {0.1, 0.0, -0.20}, 0.05);
  CHECK(box.pixels().empty());
  box.include({-0.5, 0.0, 0.2}, 0.02, {-0.5, 0.1, 0.2}, 0.02);
  CHECK(box.pixels().empty());
}

TEST_CASE("marked tiles and the others make the whole picture, each pixel once", "[film]") {
  const PixelBox all{0, 0, 23, 17};
  for (const unsigned pattern : {0U, 0xffffffffU, 0x0f3c5a91U, 0x00066600U}) {
    Tiles tiles(all.width, all.height, 5);
    REQUIRE(tiles.marked.size() == 20);
    for (std::size_t t = 0; t < 20; ++t) tiles.marked[t] = (pattern >> t & 1U) != 0;
    for (int y = 0; y < all.height; ++y)
      for (int x = 0; x < all.width; ++x) {
        const bool marked = tiles.marked[y / 5 * 5 + x / 5];
        for (const bool which : {false, true}) {
          int covered = 0;
          for (const PixelBox& box : tiles.boxes(which)) covered += holds(box, x, y) ? 1 : 0;
          CHECK(covered == (which == marked ? 1 : 0));
        }
      }
  }
  Tiles whole(all.width, all.height, 5);
  CHECK(whole.boxes(false).size() == 1);  // equal rows form one rectangle
}

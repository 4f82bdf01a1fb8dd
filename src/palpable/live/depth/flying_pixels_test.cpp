#include "palpable/live/depth/flying_pixels.h"

#include "tests/support/test.h"

#include <cmath>
#include <limits>

namespace palpable {
namespace {

constexpr float kFocal = 525;
constexpr float kFar = 3;

DepthImage kept_of(const DepthImage& depth) {
  DepthImage kept;
  leave_out_flying_pixels(depth, kFocal, kFar, kept);
  return kept;
}

// A near half plane whose edge runs through `edge` at row 0 and moves by `slant` px a row, before a
// far one. Within `width` px of the edge the depth changes evenly.
DepthImage edge_of(float edge, float slant, float width) {
  constexpr float kNear = 0.5f, kBehind = 1.2f;
  DepthImage depth(64, 48);
  for (int y = 0; y < depth.height(); ++y) {
    for (int x = 0; x < depth.width(); ++x) {
      const float beyond = static_cast<float>(x) - edge - slant * static_cast<float>(y);
      const float share = std::clamp(0.5f + beyond / std::max(width, 1e-3f), 0.0f, 1.0f);
      depth(x, y) = kNear + share * (kBehind - kNear);
    }
  }
  return depth;
}

bool is_mixed(float z) { return z > 0.501f && z < 1.199f; }

TEST_CASE("what a sensor states between a near thing and the room is left out", "[depth]") {
  for (const float slant : {-1.0f, -0.5f, 0.0f, 0.3f, 1.0f}) {
    for (const float width : {1.0f, 2.0f, 3.0f}) {
      INFO("slant " << slant << ", " << width << " px wide");
      const DepthImage depth = edge_of(32.3f - 24 * slant, slant, width), kept = kept_of(depth);
      int mixed = 0, stayed = 0, lost = 0;
      for (int y = 1; y + 1 < depth.height(); ++y) {
        for (int x = 1; x + 1 < depth.width(); ++x) {
          mixed += is_mixed(depth(x, y));
          stayed += is_mixed(depth(x, y)) && !std::isnan(kept(x, y));
          lost += !is_mixed(depth(x, y)) && std::isnan(kept(x, y));
        }
      }
      CHECK(mixed > 20);
      CHECK(lost == 0);
      // Those stay that differ from one side by less than 10 px of 1 to 2.3 mm.
      CHECK(stayed <= 0.1 * mixed);
    }
  }
}

TEST_CASE("surfaces, jumps without depths between them and single holes stay as they are",
          "[depth]") {
  const auto same = [](const DepthImage& depth) {
    const DepthImage kept = kept_of(depth);
    bool all = true;
    for (std::size_t i = 0; i < depth.size(); ++i) {
      const bool known = depth.data()[i] > 0 && depth.data()[i] <= kFar;
      all = all && (known ? kept.data()[i] == depth.data()[i] : std::isnan(kept.data()[i]));
    }
    return all;
  };
  CHECK(same(edge_of(32.3f, 0, 0)));
  CHECK(same(edge_of(20.1f, 0.4f, 0)));  // no pixel on the edge itself
  // A desk seen at 80 degrees, with holes: the depth grows by 5.7 px of itself from row to row.
  DepthImage desk(64, 48);
  for (int y = 0; y < desk.height(); ++y) {
    for (int x = 0; x < desk.width(); ++x) {
      desk(x, y) = 1 / (1.2f + 5.67f * static_cast<float>(y - 24) / kFocal);
      if ((x + 3 * y) % 7 == 0)
        desk(x, y) = y % 2 == 0 ? 0 : std::numeric_limits<float>::quiet_NaN();
    }
  }
  CHECK(same(desk));
  // The thinnest images.
  for (const auto& [width, height] : {std::pair{1, 1}, {2, 5}, {5, 2}, {3, 1}, {0, 0}}) {
    DepthImage thin(width, height);
    std::fill(thin.begin(), thin.end(), 0.7f);
    CHECK(same(thin));
  }
}

}  // namespace
}  // namespace palpable

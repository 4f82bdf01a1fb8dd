#include "palpable/depth/depth_edges.h"

#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <cmath>

namespace palpable {
namespace {

const float kNaN = std::nanf("");

TEST_CASE("a jump loses one pixel on each side and nothing else", "[depth][depth_edges]") {
  DepthImage depth(7, 5, 1.0F);
  for (int y = 0; y < 5; ++y) {
    for (int x = 4; x < 7; ++x) depth(x, y) = 1.1F;
  }
  MaskImage scratch;
  forget_jumps(depth, 0.08, scratch);
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 7; ++x) {
      INFO("x " << x << " y " << y);
      CHECK(std::isnan(depth(x, y)) == (x == 3 || x == 4));
    }
  }
}

TEST_CASE("a jump between rows counts as one between columns does", "[depth][depth_edges]") {
  DepthImage depth(3, 4, 2.0F);
  for (int x = 0; x < 3; ++x) depth(x, 3) = depth(x, 2) = 1.0F;
  MaskImage scratch;
  forget_jumps(depth, 0.5, scratch);
  for (int x = 0; x < 3; ++x) {
    CHECK(depth(x, 0) == 2.0F);
    CHECK(std::isnan(depth(x, 1)));
    CHECK(std::isnan(depth(x, 2)));
    CHECK(depth(x, 3) == 1.0F);
  }
}

TEST_CASE("a slant below the share and a border to the unknown are kept", "[depth][depth_edges]") {
  DepthImage depth(20, 1);
  for (int x = 0; x < 20; ++x) depth(x, 0) = 0.3F * std::pow(1.05F, static_cast<float>(x));
  depth(10, 0) = kNaN;
  MaskImage scratch;
  forget_jumps(depth, 0.08, scratch);
  for (int x = 0; x < 20; ++x) CHECK(std::isnan(depth(x, 0)) == (x == 10));
  CHECK(test::allocations_during([&] { forget_jumps(depth, 0.08, scratch); }) == 0);
  DepthImage nothing;
  forget_jumps(nothing, 0.08, scratch);
  CHECK(nothing.empty());
}

}  // namespace
}  // namespace palpable

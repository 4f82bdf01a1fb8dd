#include "palpable/gpu/gl_stereo.h"

#include "palpable/base/contract.h"
#include "palpable/render/gl_context.h"
#include "palpable/stereo/stereo_matcher.h"
#include "tests/support/noisy_pair.h"
#include "tests/support/test.h"

namespace palpable {
namespace {

TEST_CASE("the compute shaders find the winners of the plain loops, bit for bit", "[gpu]") {
  Result<GlContext> context = GlContext::offscreen();
  if (!context.ok()) PALPABLE_SKIP(context.problem().message);
  GlStereo stereo = value_or_throw(GlStereo::make());
  struct Case {
    int width, height, first, disparities;
    PathPenalties penalties;
  };
  unsigned seed = 0;
  for (const Case& c : {Case{70, 41, 0, 32, {3, 40, 6}}, Case{65, 9, -5, 80, {10, 61, 61}},
                        Case{40, 75, 2, 16, {0, 0, 0}}}) {
    INFO("width " << c.width << ", " << c.disparities << " disparities");
    const test::NoisyPair pair = test::noisy_pair(c.width, c.height, seed++);
    CensusCodes left, right;
    for (GrayImage& plane : left) plane.resize(c.width, c.height);
    for (GrayImage& plane : right) plane.resize(c.width, c.height);
    const StereoKernels& plain = scalar_stereo_kernels();
    plain.census(pair.left, left, nullptr);
    plain.census(pair.right, right, nullptr);
    Winners expected;
    expected.resize(c.width, c.height);
    plain.match({&left, &right, &pair.left, c.first, c.disparities, c.penalties, &expected}, 0,
                kStrips, nullptr);
    Winners found;
    stereo.find_winners(pair.left, pair.right, c.first, c.disparities, c.penalties, found);
    CHECK(found.best == expected.best);
    CHECK(found.cost == expected.cost);
    CHECK(found.before == expected.before);
    CHECK(found.after == expected.after);
  }
  CHECK(context.value().errors().count() == 0);
}

TEST_CASE("with the winners of the GPU the matcher's disparities are the same", "[gpu]") {
  Result<GlContext> context = GlContext::offscreen();
  if (!context.ok()) PALPABLE_SKIP(context.problem().message);
  GlStereo stereo = value_or_throw(GlStereo::make());
  const test::NoisyPair pair = test::noisy_pair(96, 64, 7);
  StereoMatcherSettings settings = near_matching();
  settings.disparities = 32;
  settings.guard_disparities = 16;
  MatchedPair expected, found;
  StereoMatcher(settings).match(pair.left, pair.right, expected);
  int calls = 0;
  settings.find_winners = [&](const GrayImage& left, const GrayImage& right, int first,
                              int disparities, Winners& winners) {
    ++calls;
    stereo.find_winners(left, right, first, disparities, settings.penalties, winners);
  };
  StereoMatcher(settings).match(pair.left, pair.right, found);
  CHECK(calls == 2);  // the pass and its guard
  CHECK(found.disparity == expected.disparity);
  CHECK(found.confidence == expected.confidence);
}

TEST_CASE("images of two sizes and numbers out of range are refused", "[gpu][refusal]") {
  Result<GlContext> context = GlContext::offscreen();
  if (!context.ok()) PALPABLE_SKIP(context.problem().message);
  GlStereo stereo = value_or_throw(GlStereo::make());
  const GrayImage image(20, 20);
  Winners winners;
  const PathPenalties usual{3, 40, 6};
  const PathPenalties upside_down{41, 40, 40};
  CHECK_THROWS_AS(stereo.find_winners(image, GrayImage(20, 21), 0, 16, usual, winners),
                  ContractViolation);
  CHECK_THROWS_AS(stereo.find_winners(image, image, 0, 0, usual, winners), ContractViolation);
  CHECK_THROWS_AS(stereo.find_winners(image, image, 0, 16, upside_down, winners),
                  ContractViolation);
}

}  // namespace
}  // namespace palpable

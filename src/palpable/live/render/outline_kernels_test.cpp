#include "palpable/live/render/outline_kernels.h"

#include "tests/support/test.h"

#include <random>
#include <vector>

namespace palpable {
namespace {

TEST_CASE("all instruction sets add up a window to the same bytes", "[render][outlines]") {
  constexpr int kRows = 15, kStride = 23;
  for (unsigned seed = 0; seed < 20; ++seed) {
    INFO("seed " << seed);
    auto random = test::random_case(seed);
    std::uniform_real_distribution<float> level(0, 255), inverse(0.5f, 8);
    std::bernoulli_distribution sure(0.6);
    std::vector<float> planes[6];
    for (auto& plane : planes) plane.resize(kRows * kStride);
    auto& [is_sure, r, g, b, z, moving] = planes;
    for (std::size_t i = 0; i < is_sure.size(); ++i) {
      if (!sure(random)) continue;
      is_sure[i] = 1;
      r[i] = level(random);
      g[i] = level(random);
      b[i] = level(random);
      z[i] = inverse(random);
      moving[i] = sure(random) ? 1.0f : 0.0f;
    }
    const OutlineWindow window{.sure = is_sure.data() + 3,
                               .light = r.data() + 3,
                               .warm = g.data() + 3,
                               .pink = b.data() + 3,
                               .inverse = z.data() + 3,
                               .moving = moving.data() + 3,
                               .stride = kStride,
                               .rows = kRows,
                               .dx = -26,
                               .dy = -27,
                               .step = 4,
                               .own_light = level(random),
                               .own_warm = level(random),
                               .own_pink = level(random)};
    const OutlineKernels& plain = outline_kernels().back();
    const OutlineSums sums = plain.sums(window, 3);
    CHECK(sums.near_weight[0] > 0);
    CHECK(sums.near_weight[0] < sums.all_weight[0]);
    for (const OutlineKernels& kernels : outline_kernels()) {
      INFO(kernels.name);
      const OutlineSums here = kernels.sums(window, 3);
      CHECK(here.near_fit == sums.near_fit);
      CHECK(here.near_weight == sums.near_weight);
      CHECK(here.near_inverse == sums.near_inverse);
      CHECK(here.all_fit == sums.all_fit);
      CHECK(here.all_weight == sums.all_weight);
      CHECK(here.all_inverse == sums.all_inverse);
      CHECK(here.near_moving == sums.near_moving);
      CHECK(here.all_moving == sums.all_moving);
    }
  }
}

}  // namespace
}  // namespace palpable

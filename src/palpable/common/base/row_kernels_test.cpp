#include "palpable/common/base/row_kernels.h"

#include "tests/support/test.h"

#include <cstdint>
#include <random>
#include <vector>

namespace palpable {
namespace {

constexpr std::size_t kRows = 11, kWidth = 5 * kRowStep, kStride = 7 * kRowStep;

struct Case {
  std::vector<std::int16_t> rounded;
  std::vector<float> rows, weights, vector;
};

Case some_case(unsigned seed) {
  auto random = test::random_case(seed);
  std::normal_distribution<float> number;
  std::uniform_int_distribution<int> whole(-32767, 32767);
  Case c;
  for (std::size_t k = 0; k < kRows * kStride; ++k) {
    c.rounded.push_back(static_cast<std::int16_t>(whole(random)));
    c.rows.push_back(number(random));
  }
  for (std::size_t k = 0; k < kRows; ++k) c.weights.push_back(number(random));
  for (std::size_t k = 0; k < kWidth; ++k) c.vector.push_back(number(random));
  return c;
}

}  // namespace

TEST_CASE("rows are added up to the same bytes at once and one by one, by all instruction sets",
          "[response][kernels]") {
  const Case c = some_case(1);
  const RowKernels& plain = row_kernels().back();
  for (const std::size_t width : {kRowStep, 3 * kRowStep, kWidth}) {
    std::vector<float> one_by_one(c.vector.begin(), c.vector.begin() + static_cast<long>(width));
    std::vector<float> of_floats = one_by_one;
    for (std::size_t i = 0; i < kRows; ++i) {
      plain.add(c.rounded.data() + i * kStride, c.weights[i], one_by_one);
      plain.add_floats(c.rows.data() + i * kStride, c.weights[i], of_floats);
    }
    for (const RowKernels& kernels : row_kernels()) {
      INFO(kernels.name << ", rows of " << width);
      std::vector<float> sum(c.vector.begin(), c.vector.begin() + static_cast<long>(width));
      std::vector<float> floats = sum;
      kernels.add_rows(c.rounded.data(), kStride, c.weights, sum);
      kernels.add_float_rows(c.rows.data(), kStride, c.weights, floats);
      CHECK(sum == one_by_one);
      CHECK(floats == of_floats);
    }
  }
}

TEST_CASE("dot products are the same bytes by all instruction sets, however many rows",
          "[response][kernels]") {
  const Case c = some_case(2);
  const RowKernels& plain = row_kernels().back();
  for (const std::size_t count : {std::size_t{1}, std::size_t{3}, std::size_t{4}, kRows}) {
    std::vector<float> rounded(count), floats(count), wanted(count), wanted_floats(count);
    plain.dots(c.rounded.data(), count, c.vector, wanted.data());
    plain.dots_floats(c.rows.data(), count, c.vector, wanted_floats.data());
    for (const RowKernels& kernels : row_kernels()) {
      INFO(kernels.name << ", " << count << " rows");
      kernels.dots(c.rounded.data(), count, c.vector, rounded.data());
      kernels.dots_floats(c.rows.data(), count, c.vector, floats.data());
      CHECK(rounded == wanted);
      CHECK(floats == wanted_floats);
    }
  }
}

}  // namespace palpable

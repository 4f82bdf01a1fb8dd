#include "palpable/common/reduced/mode_kernels.h"

#include "tests/support/test.h"

#include <cmath>
#include <vector>

namespace palpable {
namespace {

std::vector<float> numbers(std::size_t count, unsigned seed) {
  auto random = test::random_case(seed);
  std::uniform_real_distribution<float> number(-1, 1);
  std::vector<float> values(count);
  for (float& value : values) value = number(random);
  return values;
}

TEST_CASE("modes are summed to the same bytes by every kernel", "[reduced][kernels]") {
  // Lengths around those of all vectors; numbers of columns around kTogether.
  for (const std::size_t rows : {0, 1, 3, 15, 16, 17, 64, 333}) {
    for (const std::size_t columns : {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 15, 16, 60}) {
      const std::size_t stride = rows + 5;
      const std::vector<float> F = numbers(stride * columns + rows, 1), w = numbers(columns, 2);
      for (const bool add : {false, true}) {
        std::vector<float> expected = numbers(rows, 3), u(rows);
        for (std::size_t k = 0; k < rows; ++k) {
          if (!add) expected[k] = 0;
          for (std::size_t i = 0; i < columns; ++i) expected[k] += w[i] * F[2 + i * stride + k];
        }
        for (const ModeKernels& kernels : mode_kernels()) {
          INFO(kernels.name << ", " << rows << " x " << columns << ", add " << add);
          u = numbers(rows, 3);
          kernels.sum({F.data() + 2, stride, columns}, w.data(), add, u);
          CHECK(u == expected);
        }
      }
    }
  }
}

TEST_CASE("von Mises stress is the same bytes from every kernel", "[reduced][kernels]") {
  for (const std::size_t count : {0, 1, 2, 7, 16, 33, 100}) {
    const std::vector<float> stress = numbers(6 * count, 4);
    std::vector<float> expected(count), result(count);
    mode_kernels().back().von_mises(stress.data(), expected);
    for (std::size_t k = 0; k < count; ++k) {
      const float* s = stress.data() + 6 * k;
      const double mean = (double(s[0]) + s[1] + s[2]) / 3;
      double deviator = 0;
      for (int c = 0; c < 3; ++c) {
        deviator += std::pow(s[c] - mean, 2) + 2 * std::pow(double(s[c + 3]), 2);
      }
      CHECK(expected[k] == Approx(std::sqrt(1.5 * deviator)).epsilon(1e-6));
    }
    for (const ModeKernels& kernels : mode_kernels()) {
      INFO(kernels.name << ", " << count);
      kernels.von_mises(stress.data(), result);
      CHECK(result == expected);
    }
  }
}

TEST_CASE("vectors come to length 1 in the same bytes from every kernel", "[reduced][kernels]") {
  for (const std::size_t count : {0, 1, 7, 16, 33, 100}) {
    std::vector<float> vectors = numbers(3 * count, 5);
    if (count > 3) std::fill_n(vectors.begin() + 6, 3, 0.0f);
    std::vector<float> expected = vectors;
    mode_kernels().back().normalise(expected.data(), count);
    for (std::size_t k = 0; k < count; ++k) {
      const float* v = expected.data() + 3 * k;
      const double length = std::hypot(double(v[0]), double(v[1]), double(v[2]));
      CHECK(length == Approx(count > 3 && k == 2 ? 0 : 1).margin(1e-6));
      CHECK(v[0] * vectors[3 * k] >= 0);
    }
    for (const ModeKernels& kernels : mode_kernels()) {
      INFO(kernels.name << ", " << count);
      std::vector<float> result = vectors;
      kernels.normalise(result.data(), count);
      CHECK(result == expected);
    }
  }
}

TEST_CASE("the plain kernels are there on every processor", "[reduced][kernels]") {
  CHECK(std::string(mode_kernels().back().name) == "plain");
}

}  // namespace
}  // namespace palpable

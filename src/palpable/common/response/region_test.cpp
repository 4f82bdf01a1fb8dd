#include "palpable/common/response/region.h"

#include "palpable/common/response/symmetric_form.h"
#include "tests/support/test.h"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace palpable {
namespace {

using Eigen::VectorXd;
using test::tolerance;

constexpr int kModes = 16, kLeading = 5;

// The distinct coefficients at any order of their indices.
double coefficient(const std::vector<double>& distinct, int n, std::array<int, 4> index,
                   int degree) {
  std::sort(index.begin(), index.begin() + degree);
  std::size_t at = 0;
  std::array<int, 4> i{};
  for (i[0] = 0; i[0] < n; ++i[0]) {
    for (i[1] = i[0]; i[1] < n; ++i[1]) {
      for (i[2] = i[1]; i[2] < n; ++i[2]) {
        for (i[3] = degree == 4 ? i[2] : 0; i[3] < (degree == 4 ? n : 1); ++i[3]) {
          if (std::equal(index.begin(), index.begin() + degree, i.begin())) return distinct[at];
          ++at;
        }
      }
    }
  }
  return 0;
}

struct Forms {
  std::vector<double> cubic = std::vector<double>(distinct_coefficients(kModes, 3));
  std::vector<double> quartic = std::vector<double>(distinct_coefficients(kLeading, 4));
  FormRows cubic_rows, quartic_rows;

  Forms() {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> value(-1, 1);
    for (double& c : cubic) c = value(random);
    for (double& c : quartic) c = value(random);
    cubic_rows = FormRows(rounded(kModes, 3, cubic));
    quartic_rows = FormRows(rounded(kLeading, 4, quartic));
  }

  [[nodiscard]] RegionForms region() const { return {cubic_rows, quartic_rows}; }
  // - 1/2 A(a, a) - 1/6 E(a, a, a) of region.h, index by index.
  [[nodiscard]] VectorXd q(const VectorXd& a) const {
    VectorXd result = VectorXd::Zero(kModes);
    for (int i = 0; i < kModes; ++i) {
      for (int j = 0; j < kModes; ++j) {
        for (int k = 0; k < kModes; ++k) {
          result[i] -= 0.5 * coefficient(cubic, kModes, {i, j, k}, 3) * a[j] * a[k];
        }
      }
    }
    for (int i = 0; i < kLeading; ++i) {
      for (int j = 0; j < kLeading; ++j) {
        for (int k = 0; k < kLeading; ++k) {
          for (int l = 0; l < kLeading; ++l) {
            result[i] -= coefficient(quartic, kLeading, {i, j, k, l}, 4) * a[j] * a[k] * a[l] / 6;
          }
        }
      }
    }
    return result;
  }
};

VectorXd some_coordinates() {
  VectorXd a(kModes);
  for (int k = 0; k < kModes; ++k) a[k] = 0.3 * std::cos(1.7 * k + 0.4);
  return a;
}

TEST_CASE("a region's response is the second and third order of its energy", "[response]") {
  const Forms forms;
  RegionResponse response(kModes, kLeading);
  const VectorXd a = some_coordinates();
  const Eigen::VectorXf coordinates = a.cast<float>();
  response.evaluate(forms.region(), {coordinates.data(), kModes});
  const VectorXd expected = forms.q(a);
  for (int k = 0; k < kModes; ++k) {
    CHECK(std::abs(static_cast<double>(response.q()[static_cast<std::size_t>(k)]) - expected[k]) <
          tolerance(1e-3, "136 terms of up to 0.05, each rounded by 3e-5"));
  }
}

TEST_CASE("a region's H is the derivative of its response, and symmetric", "[response]") {
  const Forms forms;
  RegionResponse response(kModes, kLeading);
  const VectorXd a = some_coordinates();
  const Eigen::VectorXf coordinates = a.cast<float>();
  response.evaluate(forms.region(), {coordinates.data(), kModes});
  Eigen::MatrixXf H(kModes, kModes);
  for (int k = 0; k < kModes; ++k) {
    const Eigen::VectorXf unit = Eigen::VectorXf::Unit(kModes, k);
    response.times({unit.data(), kModes}, {H.col(k).data(), kModes});
  }
  CHECK(H.isApprox(H.transpose()));
  constexpr double kStep = 1e-4;
  for (int k = 0; k < kModes; ++k) {
    const VectorXd step = kStep * VectorXd::Unit(kModes, k);
    const VectorXd slope = (forms.q(a + step) - forms.q(a - step)) / (2 * kStep);
    CHECK((H.col(k).cast<double>() - slope).norm() <
          tolerance(2e-3, "a cubic's central difference is off by 1e-8; rounding by 3e-5 a term"));
  }
}

TEST_CASE("a region reports how large its last order is", "[response]") {
  const Forms forms;
  RegionResponse response(kModes, kLeading);
  const Eigen::VectorXf coordinates = some_coordinates().cast<float>(), small = 0.1f * coordinates;
  response.evaluate(forms.region(), {coordinates.data(), kModes});
  const float share = response.last_share();
  response.evaluate(forms.region(), {small.data(), kModes});
  // |q_3| falls with the third power, |a| + |q_2| nearly with the first.
  CHECK(response.last_share() < 0.03f * share);
  CHECK(share > 0.0f);
}

TEST_CASE("beyond its series' end a region's response is extended along the ray", "[response]") {
  const Forms forms;
  RegionResponse response(kModes, kLeading);
  const auto q_at = [&](float size) {
    const Eigen::VectorXf coordinates = size * some_coordinates().cast<float>();
    response.evaluate(forms.region(), {coordinates.data(), kModes});
    return Eigen::VectorXf(Eigen::Map<const Eigen::VectorXf>(response.q().data(), kModes));
  };
  float end = 1;  // of the series, by size
  while (q_at(end), response.last_share() < kSeriesEnd) end *= 1.01f;
  const Eigen::VectorXf before = q_at(end / 1.02f), at_end = q_at(end);
  CHECK((at_end - before).norm() < 0.1f * at_end.norm());  // no jump
  // Beyond it the response is linear; the cubic would be 1,000 times as large.
  CHECK(q_at(10 * end).isApprox(10 * at_end, 0.05f));
  CHECK(response.last_share() > kSeriesEnd);  // and it is reported
}

}  // namespace
}  // namespace palpable

#include "palpable/bake/solid/energy_tensors.h"

#include "palpable/bake/solid/jet.h"
#include "palpable/common/base/contract.h"

#include <algorithm>
#include <variant>

namespace palpable {
namespace {

using Series = Jet<double, 4>;
using Direction = std::array<double, 9>;

// Coefficients of a^3 and a^4 of Psi(F + a v): D3 Psi (v, v, v) / 6 and D4 Psi (v, v, v, v) / 24.
template <class Law>
std::array<double, 2> last_terms(const Law& law, const Eigen::Matrix3d& F, const Direction& v) {
  Tensor<Series> path{};
  for (int k = 0; k < 9; ++k) {
    path.m[k].c[0] = F(k);
    path.m[k].c[1] = v[static_cast<std::size_t>(k)];
  }
  const Series psi = energy_density(law, deformation(path));
  return {psi.c[3], psi.c[4]};
}

// The form T(e_a, e_b, ...) of n directions from its values on the diagonal, Q(v) = T(v, v, ...):
//
//     T = 1 / (n! 2^n) sum over signs s of s_1 ... s_n Q(s_1 e_a + s_2 e_b + ...)
//
// A term does not change when all signs are flipped. Therefore the sum runs over s_1 = 1 only and
// counts twice.
template <std::size_t n, class Diagonal>
double polarised(const std::array<int, n>& entries, const Diagonal& diagonal) {
  double sum = 0;
  for (unsigned signs = 0; signs < (1U << (n - 1)); ++signs) {
    Direction v{};
    double sign = 1;
    for (std::size_t k = 0; k < n; ++k) {
      const double s = k > 0 && (signs >> (k - 1) & 1) != 0 ? -1.0 : 1.0;
      v[static_cast<std::size_t>(entries[k])] += s;
      sign *= s;
    }
    sum += sign * diagonal(v);
  }
  // Q is n! times the series' coefficient, which cancels the n! above.
  return sum / static_cast<double>(1U << (n - 1));
}

template <class Law>
EnergyTensors tensors_of(const Law& law, const Eigen::Matrix3d& F) {
  EnergyTensors tensors;
  std::size_t third = 0, fourth = 0;
  for (int a = 0; a < 9; ++a) {
    for (int b = a; b < 9; ++b) {
      for (int c = b; c < 9; ++c) {
        tensors.third[third++] =
            polarised<3>({a, b, c}, [&](const Direction& v) { return last_terms(law, F, v)[0]; });
        for (int d = c; d < 9; ++d) {
          tensors.fourth[fourth++] = polarised<4>(
              {a, b, c, d}, [&](const Direction& v) { return last_terms(law, F, v)[1]; });
        }
      }
    }
  }
  return tensors;
}

}  // namespace

EnergyTensors energy_tensors(const Material& material, const Eigen::Matrix3d& F) {
  PALPABLE_EXPECT(F.determinant() > 0, "an inverted element has no stress");
  return std::visit([&](const auto& law) { return tensors_of(law, F); }, material);
}

FullEnergyTensors unfolded(const EnergyTensors& tensors) {
  FullEnergyTensors full;
  std::size_t third = 0, fourth = 0;
  for (std::size_t a = 0; a < 9; ++a) {
    for (std::size_t b = a; b < 9; ++b) {
      for (std::size_t c = b; c < 9; ++c) {
        std::array<std::size_t, 3> i{a, b, c};
        do {
          full.third[81 * i[0] + 9 * i[1] + i[2]] = tensors.third[third];
        } while (std::next_permutation(i.begin(), i.end()));
        ++third;
        for (std::size_t d = c; d < 9; ++d) {
          std::array<std::size_t, 4> j{a, b, c, d};
          do {
            full.fourth[729 * j[0] + 81 * j[1] + 9 * j[2] + j[3]] = tensors.fourth[fourth];
          } while (std::next_permutation(j.begin(), j.end()));
          ++fourth;
        }
      }
    }
  }
  return full;
}

}  // namespace palpable

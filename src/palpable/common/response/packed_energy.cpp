// Eight pairs of modes at a time. This file is compiled without contraction of a * b + c
// (CMakeLists.txt), so that all processors give the same bytes.

#include "palpable/common/response/packed_energy.h"

#include "palpable/common/response/float_lanes.h"

#include <cstddef>
#include <vector>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

struct alignas(32) PackOfPairs {
  FloatPack v;
};

// Rows of the quartic part that are read together.
constexpr Index kRows = 4;

// All are padded with zeros to full packs of eight. `above` is the part of the quartic matrix above
// the diagonal, in groups of kRows rows: of a group first the packs in which its part above the
// diagonal begins, then the next packs, and so on.
struct Packed {
  const PackOfPairs* above;
  const PackOfPairs* diagonal;
  const PackOfPairs* cubic;  // (packs x n), the n modes of a pack next to each other
  const float* q;            // (n)
  const PackOfPairs* products;
  PackOfPairs *cubic_sum, *quartic_sum;
  Index modes, packs;
};

struct Sums {
  PALPABLE_ALWAYS_INLINE static int run(const Packed& e) {
    const PackOfPairs* from = e.cubic;
    for (Index k = 0; k < e.packs; ++k) {
      FloatPack sum{};
      for (Index i = 0; i < e.modes; ++i, ++from) sum += e.q[i] * from->v;
      e.cubic_sum[k].v = sum;
      e.quartic_sum[k].v = e.diagonal[k].v * e.products[k].v;
    }
    from = e.above;
    for (Index row = 0; row < kPackSize * e.packs; row += kRows) {
      const Index first = row / kPackSize, lane = row % kPackSize;
      float here[kRows];
      FloatPack sum[kRows]{};
      for (Index r = 0; r < kRows; ++r) here[r] = e.products[first].v[lane + r];
      for (Index k = first; k < e.packs; ++k, from += kRows) {
        const FloatPack products = e.products[k].v;
        FloatPack below = e.quartic_sum[k].v;
        for (Index r = 0; r < kRows; ++r) {
          sum[r] += from[r].v * products;
          below += here[r] * from[r].v;
        }
        e.quartic_sum[k].v = below;
      }
      for (Index r = 0; r < kRows; ++r) {
        const FloatPack& s = sum[r];
        e.quartic_sum[first].v[lane + r] +=
            ((s[0] + s[1]) + (s[2] + s[3])) + ((s[4] + s[5]) + (s[6] + s[7]));
      }
    }
    return 0;
  }
};

Index packs_of(Index numbers) { return (numbers + kPackSize - 1) / kPackSize; }

float number(const std::vector<PackOfPairs>& packs, Index at) {
  return packs[static_cast<std::size_t>(at / kPackSize)].v[at % kPackSize];
}
void set_number(std::vector<PackOfPairs>& packs, Index at, double value) {
  packs[static_cast<std::size_t>(at / kPackSize)].v[at % kPackSize] = static_cast<float>(value);
}

}  // namespace

struct PackedEnergy::Work {
  SimdLevel level;
  Index n, packs;
  VectorXd K;  // (P)
  std::vector<PackOfPairs> above, diagonal, cubic, products, cubic_sum, quartic_sum;
  std::vector<float> q;

  Work(const QuarticEnergy& energy, SimdLevel the_level)
      : level(the_level),
        n(energy.modes()),
        packs(packs_of(energy.K.size())),
        K(energy.K),
        diagonal(static_cast<std::size_t>(packs)),
        cubic(static_cast<std::size_t>(packs * n)),
        products(diagonal),
        cubic_sum(diagonal),
        quartic_sum(diagonal),
        q(static_cast<std::size_t>(n)) {
    const Index P = K.size();
    for (Index i = 0; i < P; ++i) {
      set_number(diagonal, i, energy.D(i, i));
      for (Index j = 0; j < n; ++j) {
        set_number(cubic, (i / kPackSize * n + j) * kPackSize + i % kPackSize, energy.C(i, j));
      }
    }
    for (Index row = 0; row < kPackSize * packs; row += kRows) {
      for (Index k = row / kPackSize; k < packs; ++k) {
        for (Index i = row; i < row + kRows; ++i) {
          above.emplace_back();
          for (Index lane = 0; lane < kPackSize; ++lane) {
            const Index j = k * kPackSize + lane;
            if (i < j && j < P) above.back().v[lane] = static_cast<float>(energy.D(i, j));
          }
        }
      }
    }
  }
};

PackedEnergy::PackedEnergy(const QuarticEnergy& energy, SimdLevel level)
    : work_(std::make_unique<Work>(energy, level)) {}
PackedEnergy::~PackedEnergy() = default;
PackedEnergy::PackedEnergy(PackedEnergy&&) noexcept = default;

void PackedEnergy::evaluate(const VectorXd& q, VectorXd& gradient, MatrixXd& hessian) {
  Work& w = *work_;
  Index row = 0;
  for (Index j = 0; j < w.n; ++j) {
    w.q[static_cast<std::size_t>(j)] = static_cast<float>(q[j]);
    for (Index i = 0; i <= j; ++i, ++row) {
      set_number(w.products, row, (i == j ? 0.5 : 1.0) * q[i] * q[j]);
    }
  }
  const Packed packed{w.above.data(),
                      w.diagonal.data(),
                      w.cubic.data(),
                      w.q.data(),
                      w.products.data(),
                      w.cubic_sum.data(),
                      w.quartic_sum.data(),
                      w.n,
                      w.packs};
  run_at<Sums>(w.level, packed);
  gradient.setZero(w.n);
  hessian.resize(w.n, w.n);
  row = 0;
  for (Index j = 0; j < w.n; ++j) {
    for (Index i = 0; i <= j; ++i, ++row) {
      const double cubic = static_cast<double>(number(w.cubic_sum, row)),
                   quartic = static_cast<double>(number(w.quartic_sum, row));
      const double force = w.K[row] + 0.5 * cubic + quartic / 3;
      gradient[i] += force * q[j];
      if (i != j) gradient[j] += force * q[i];
      hessian(i, j) = hessian(j, i) = w.K[row] + cubic + quartic;
    }
  }
}

}  // namespace palpable

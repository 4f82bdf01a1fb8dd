// Eight elements at a time, as solid/element_kernels.cpp does. This file is compiled without
// contraction of a * b + c (CMakeLists.txt), so that all processors give the same bytes.

#include "palpable/touch/shell_stress.h"

#include "palpable/base/contract.h"
#include "palpable/material/law.h"
#include "palpable/material/node_rows.h"
#include "palpable/material/simd.h"
#include "palpable/material/tensor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <variant>
#include <vector>

namespace palpable {
namespace {

// An element that is pressed to less of its volume is on its way to being turned inside out.
constexpr double kLeastVolume = 0.01;
// Pa: more is no stress of a body; squares of it are numbers still.
constexpr double kMostStress = 1e15;

using FloatPack = float __attribute__((vector_size(kPackSize * sizeof(float))));

struct alignas(32) PlaceRow {
  Quad u;  // m; the fourth number is 0
};

// A symmetric tensor, and two numbers that mean nothing.
struct alignas(32) StressRow {
  FloatPack s;
};

// Eight elements of one material. The gradients of an element's nodes sum to zero: that of node 0
// is not kept.
template <int A, int Q>
struct alignas(32) ShellBlock {
  FloatPack g[Q][A - 1][3];  // 1/m
  int nodes[A][kPackSize];
};

struct Term {
  int point;  // a StressRow
  float weight;
};

struct Recovery {
  const int* first;
  const Term* terms;
  int vertices;
};

template <int A>
struct Differences {
  Pack at[A - 1][3];  // m, u_a - u_0
};

template <int A, int Q>
PALPABLE_ALWAYS_INLINE void gather_differences(const PlaceRow* rows, const ShellBlock<A, Q>& block,
                                               Differences<A>& u) {
  Pack first[3];
  gather<&PlaceRow::u>(rows, block.nodes[0], first);
  for (int a = 1; a < A; ++a) {
    gather<&PlaceRow::u>(rows, block.nodes[a], u.at[a - 1]);
    for (int i = 0; i < 3; ++i) u.at[a - 1][i] -= first[i];
  }
}

// 1 + sum_a (u_a - u_0) (dN_a/dX)^T
template <int A>
PALPABLE_ALWAYS_INLINE Tensor<Pack> gradient(const Differences<A>& u,
                                             const FloatPack (&g)[A - 1][3]) {
  Tensor<Pack> F{};
  for (int J = 0; J < 3; ++J) {
    for (int a = 0; a < A - 1; ++a) {
      const Pack slope = __builtin_convertvector(g[a][J], Pack);
      for (int i = 0; i < 3; ++i) F(i, J) += u.at[a][i] * slope;
    }
    F(J, J) += 1.0;
  }
  return F;
}

// As deformation() of law.h, with a volume that is not less than the least.
PALPABLE_ALWAYS_INLINE Deformation<Pack> bounded_deformation(const Tensor<Pack>& F) {
  Deformation<Pack> d;
  d.F = F;
  const Tensor<Pack> cofactor = cofactors(F);
  const Pack J = F(0, 0) * cofactor(0, 0) + F(1, 0) * cofactor(1, 0) + F(2, 0) * cofactor(2, 0);
  d.J = J > kLeastVolume ? J : Pack{} + kLeastVolume;  // also where J is no number
  d.G = (1.0 / d.J) * cofactor;
  d.I1 = inner(F, F);
  return d;
}

// One component of a symmetric tensor, in single precision; what is no number is the most.
PALPABLE_ALWAYS_INLINE FloatPack bounded(Pack s) {
  s = s < kMostStress ? s : Pack{} + kMostStress;
  s = s > -kMostStress ? s : Pack{} - kMostStress;
  return __builtin_convertvector(s, FloatPack);
}

// Rows of eight elements from components of eight elements.
PALPABLE_ALWAYS_INLINE void store_rows(const FloatPack (&s)[6], StressRow* to) {
  for (int lane = 0; lane < kPackSize; ++lane) {
    to[lane].s = FloatPack{s[0][lane], s[1][lane], s[2][lane], s[3][lane],
                           s[4][lane], s[5][lane], 0.0f,       0.0f};
  }
}

struct Stresses {
  template <class Law, int A, int Q>
  PALPABLE_ALWAYS_INLINE static int run(const Law& law, std::span<const ShellBlock<A, Q>>& blocks,
                                        const PlaceRow*& rows, StressRow*& to) {
    constexpr int kRow[6] = {0, 1, 2, 0, 1, 2}, kColumn[6] = {0, 1, 2, 1, 2, 0};
    for (const ShellBlock<A, Q>& block : blocks) {
      Differences<A> u;
      gather_differences(rows, block, u);
      for (int q = 0; q < Q; ++q, to += kPackSize) {
        const Deformation<Pack> d = bounded_deformation(gradient<A>(u, block.g[q]));
        const Tensor<Pack> P = first_piola(law, d);
        const Pack shrunk = 1.0 / d.J;
        FloatPack s[6];
        for (int c = 0; c < 6; ++c) {
          const int i = kRow[c], j = kColumn[c];
          Pack sum = P(i, 0) * d.F(j, 0) + P(i, 1) * d.F(j, 1) + P(i, 2) * d.F(j, 2);
          s[c] = bounded(sum * shrunk);
        }
        store_rows(s, to);
      }
    }
    return 0;
  }
};

struct Recover {
  PALPABLE_ALWAYS_INLINE static int run(const Recovery& recovery, const StressRow*& rows,
                                        float*& von_mises, float*& cauchy) {
    for (int v = 0; v < recovery.vertices; ++v) {
      FloatPack sum{};
      for (int k = recovery.first[v]; k < recovery.first[v + 1]; ++k) {
        const Term& term = recovery.terms[k];
        sum += term.weight * rows[term.point].s;
      }
      const float xy = sum[0] - sum[1], yz = sum[1] - sum[2], zx = sum[2] - sum[0];
      const float shear = sum[3] * sum[3] + sum[4] * sum[4] + sum[5] * sum[5];
      von_mises[v] = __builtin_sqrtf(0.5f * (xy * xy + yz * yz + zx * zx) + 3.0f * shear);
      if (cauchy == nullptr) continue;
      for (int c = 0; c < 6; ++c) cauchy[6 * v + c] = sum[c];
    }
    return 0;
  }
};

// The elements of a shell that have one material, in blocks.
template <int A, int Q>
struct ShellPart {
  Material material;
  std::vector<ShellBlock<A, Q>> blocks;
};

template <int A, int Q>
void set_lane(const ShellTable& table, int element, int lane, ShellBlock<A, Q>& block) {
  for (int q = 0; q < Q; ++q) {
    const Eigen::Matrix3Xd g = gradients_at(table, element, q);
    for (int a = 1; a < A; ++a) {
      for (int J = 0; J < 3; ++J) block.g[q][a - 1][J][lane] = static_cast<float>(g(J, a));
    }
  }
  const std::span<const int> nodes = table.nodes_of(element);
  for (int a = 0; a < A; ++a) block.nodes[a][lane] = nodes[static_cast<std::size_t>(a)];
}

// @param row_of_point  (Q E) where the stress of each point will be
template <int A, int Q>
std::vector<ShellPart<A, Q>> parts_of(const ShellTable& table, std::vector<int>& row_of_point) {
  std::vector<ShellPart<A, Q>> parts;
  row_of_point.assign(static_cast<std::size_t>(Q * table.element_count()), 0);
  int before = 0;  // blocks of former parts
  for (std::size_t m = 0; m < table.materials.size(); ++m) {
    ShellPart<A, Q> part{table.materials[m], {}};
    int count = 0, last = -1;
    for (int e = 0; e < table.element_count(); ++e) {
      if (table.material_of[static_cast<std::size_t>(e)] != static_cast<int>(m)) continue;
      if (count % kPackSize == 0) part.blocks.emplace_back();
      set_lane(table, e, count % kPackSize, part.blocks.back());
      for (int q = 0; q < Q; ++q) {
        row_of_point[static_cast<std::size_t>(Q * e + q)] =
            ((before + count / kPackSize) * Q + q) * kPackSize + count % kPackSize;
      }
      last = e;
      ++count;
    }
    // The last block is filled up with copies.
    for (; last >= 0 && count % kPackSize != 0; ++count) {
      set_lane(table, last, count % kPackSize, part.blocks.back());
    }
    before += static_cast<int>(part.blocks.size());
    if (last >= 0) parts.push_back(std::move(part));
  }
  return parts;
}

template <int A, int Q>
std::size_t rows_of(const std::vector<ShellPart<A, Q>>& parts) {
  std::size_t rows = 0;
  for (const auto& part : parts)
    rows += part.blocks.size() * static_cast<std::size_t>(Q * kPackSize);
  return rows;
}

template <int A, int Q>
void fill(SimdLevel level, const std::vector<ShellPart<A, Q>>& parts, const PlaceRow* rows,
          StressRow* to) {
  for (const ShellPart<A, Q>& part : parts) {
    std::span<const ShellBlock<A, Q>> blocks(part.blocks);
    std::visit([&](const auto& law) { run_at<Stresses>(level, law, blocks, rows, to); },
               part.material);
  }
}

}  // namespace

struct ShellStress::Work {
  SimdLevel level = best_simd_level();
  int vertices;
  Eigen::Matrix3Xd preload;
  std::vector<ShellPart<4, 1>> linear;
  std::vector<ShellPart<10, 4>> quadratic;
  std::vector<int> first;
  std::vector<Term> terms;
  std::vector<PlaceRow> places;   // (W)
  std::vector<StressRow> stress;  // of all points

  Work(const ShellTable& table, int V) : vertices(V), preload(table.preload), first(table.first) {
    std::vector<int> row_of_point;
    if (table.element_nodes == 4) {
      linear = parts_of<4, 1>(table, row_of_point);
    } else {
      quadratic = parts_of<10, 4>(table, row_of_point);
    }
    for (std::size_t k = 0; k < table.points.size(); ++k) {
      terms.push_back({row_of_point[static_cast<std::size_t>(table.points[k])], table.weights[k]});
    }
    places.assign(static_cast<std::size_t>(table.nodes()), PlaceRow{});
    stress.assign(rows_of(linear) + rows_of(quadratic), StressRow{});
  }
};

ShellStress::ShellStress(const ShellTable& table, int vertices) {
  PALPABLE_EXPECT(trouble_of(table, vertices).empty(), "a shell is consistent");
  work_ = std::make_unique<Work>(table, vertices);
}
ShellStress::~ShellStress() = default;
ShellStress::ShellStress(ShellStress&&) noexcept = default;

int ShellStress::vertices() const { return work_->vertices; }
int ShellStress::nodes() const { return static_cast<int>(work_->places.size()); }

void ShellStress::evaluate(const Eigen::Matrix3Xf& u, std::span<float> von_mises,
                           std::span<float> cauchy) {
  Work& w = *work_;
  const auto V = static_cast<std::size_t>(w.vertices);
  PALPABLE_EXPECT(
      u.cols() == nodes() && von_mises.size() == V && (cauchy.empty() || cauchy.size() == 6 * V),
      "a displacement of the shell's nodes, and room for the skin's stress");
  for (Eigen::Index n = 0; n < u.cols(); ++n) {
    const Eigen::Vector3d here = w.preload.col(n) + u.col(n).cast<double>();
    w.places[static_cast<std::size_t>(n)].u = Quad{here[0], here[1], here[2], 0.0};
  }
  fill(w.level, w.linear, w.places.data(), w.stress.data());
  fill(w.level, w.quadratic, w.places.data(), w.stress.data());
  const Recovery recovery{w.first.data(), w.terms.data(), w.vertices};
  const StressRow* rows = w.stress.data();
  float *to = von_mises.data(), *tensors = cauchy.empty() ? nullptr : cauchy.data();
  run_at<Recover>(w.level, recovery, rows, to, tensors);
}

}  // namespace palpable

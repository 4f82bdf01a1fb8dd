// Eight elements at a time (float_lanes.h). This file is compiled without contraction of a * b + c
// (CMakeLists.txt), so that all processors give the same bytes.

#include "palpable/common/response/shell_stress.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/geometry/element_order.h"
#include "palpable/common/response/float_lanes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <variant>
#include <vector>

namespace palpable {
namespace {

// The six components of a symmetric tensor, and two numbers without meaning.
struct alignas(32) StressRow {
  FloatPack s;
};

// Eight elements of one material. The gradients of an element's nodes sum to zero, so that of node
// 0 is not stored.
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
  const int* vertex;  // in the order in which they are computed
  const int* first;
  const Term* terms;
  int vertices;
};

template <int A>
struct Differences {
  FloatPack at[A - 1][3];  // m, u_a - u_0
};

template <int A, int Q>
PALPABLE_ALWAYS_INLINE void gather_differences(const FourRow* rows, const ShellBlock<A, Q>& block,
                                               Differences<A>& u) {
  FloatPack first[3];
  gather(rows, block.nodes[0], first);
  for (int a = 1; a < A; ++a) {
    gather(rows, block.nodes[a], u.at[a - 1]);
    for (int i = 0; i < 3; ++i) u.at[a - 1][i] -= first[i];
  }
}

// 1 + sum_a (u_a - u_0) (dN_a/dX)^T
template <int A>
PALPABLE_ALWAYS_INLINE Tensor<Lanes> gradient(const Differences<A>& u,
                                              const FloatPack (&g)[A - 1][3]) {
  Tensor<Lanes> F{};
  for (int J = 0; J < 3; ++J) {
    for (int i = 0; i < 3; ++i) {
      FloatPack sum = u.at[0][i] * g[0][J];
      for (int a = 1; a < A - 1; ++a) sum += u.at[a][i] * g[a][J];
      F(i, J).v = i == J ? sum + 1.0f : sum;
    }
  }
  return F;
}

// Turns the components of eight elements into one row per element: an 8 x 8 transpose.
PALPABLE_ALWAYS_INLINE void store_stress_rows(const FloatPack (&s)[6], StressRow* to) {
  const FloatPack none{};
  const auto mixed = [](const FloatPack& a, const FloatPack& b, bool high) {
    return high ? __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15)
                : __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13);
  };
  for (const bool high : {false, true}) {
    const FloatPack s01 = mixed(s[0], s[1], high), s23 = mixed(s[2], s[3], high);
    const FloatPack s45 = mixed(s[4], s[5], high);
    // Components 0 to 3, and 4 to 7, of elements k and k + 4.
    const FloatPack low_0 = __builtin_shufflevector(s01, s23, 0, 1, 8, 9, 4, 5, 12, 13);
    const FloatPack low_1 = __builtin_shufflevector(s01, s23, 2, 3, 10, 11, 6, 7, 14, 15);
    const FloatPack high_0 = __builtin_shufflevector(s45, none, 0, 1, 8, 9, 4, 5, 12, 13);
    const FloatPack high_1 = __builtin_shufflevector(s45, none, 2, 3, 10, 11, 6, 7, 14, 15);
    StressRow* row = to + (high ? 2 : 0);
    row[0].s = __builtin_shufflevector(low_0, high_0, 0, 1, 2, 3, 8, 9, 10, 11);
    row[1].s = __builtin_shufflevector(low_1, high_1, 0, 1, 2, 3, 8, 9, 10, 11);
    row[4].s = __builtin_shufflevector(low_0, high_0, 4, 5, 6, 7, 12, 13, 14, 15);
    row[5].s = __builtin_shufflevector(low_1, high_1, 4, 5, 6, 7, 12, 13, 14, 15);
  }
}

struct Stresses {
  template <class Law, int A, int Q>
  PALPABLE_ALWAYS_INLINE static int run(const Law& law, std::span<const ShellBlock<A, Q>>& blocks,
                                        const FourRow*& rows, StressRow*& to) {
    for (const ShellBlock<A, Q>& block : blocks) {
      Differences<A> u;
      gather_differences(rows, block, u);
      for (int q = 0; q < Q; ++q, to += kPackSize) {
        FloatPack s[6];
        cauchy_stress(law, gradient<A>(u, block.g[q]), s);
        store_stress_rows(s, to);
      }
    }
    return 0;
  }
};

struct Recover {
  PALPABLE_ALWAYS_INLINE static int run(const Recovery& recovery, const StressRow*& rows,
                                        float*& von_mises, float*& cauchy) {
    for (int k = 0; k < recovery.vertices; ++k) {
      const int v = recovery.vertex[k];
      // Four independent sums, so that an addition need not wait for the one before it.
      FloatPack sums[4]{};
      const Term* term = recovery.terms + recovery.first[k];
      const Term* const last = recovery.terms + recovery.first[k + 1];
      for (; term + 4 <= last; term += 4) {
        for (int i = 0; i < 4; ++i) sums[i] += term[i].weight * rows[term[i].point].s;
      }
      for (; term != last; ++term) sums[0] += term->weight * rows[term->point].s;
      const FloatPack sum = (sums[0] + sums[1]) + (sums[2] + sums[3]);
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

Eigen::Matrix3Xd middles_of(const ShellTable& table) {
  Eigen::Matrix3Xd middles(3, table.element_count());
  for (int e = 0; e < table.element_count(); ++e) {
    const std::span<const int> nodes = table.nodes_of(e);
    middles.col(e) = table.stress_free(Eigen::all, nodes).rowwise().mean();
  }
  return middles;
}

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

// @param elements      in the order in which they are computed
// @param place_of      (W) index of each node in the array of displacements
// @param row_of_point  (Q E) out: index of each point in the array of stresses
template <int A, int Q>
std::vector<ShellPart<A, Q>> parts_of(const ShellTable& table, const std::vector<int>& elements,
                                      const std::vector<int>& place_of,
                                      std::vector<int>& row_of_point) {
  std::vector<ShellPart<A, Q>> parts;
  row_of_point.assign(std::size_t{Q} * static_cast<std::size_t>(table.element_count()), 0);
  int before = 0;  // blocks of the parts before
  for (std::size_t m = 0; m < table.materials.size(); ++m) {
    ShellPart<A, Q> part{table.materials[m], {}};
    int count = 0, last = -1;
    for (const int e : elements) {
      if (table.material_of[static_cast<std::size_t>(e)] != static_cast<int>(m)) continue;
      if (count % kPackSize == 0) part.blocks.emplace_back();
      set_lane(table, e, count % kPackSize, part.blocks.back());
      for (int q = 0; q < Q; ++q) {
        row_of_point[std::size_t{Q} * static_cast<std::size_t>(e) + static_cast<std::size_t>(q)] =
            ((before + count / kPackSize) * Q + q) * kPackSize + count % kPackSize;
      }
      last = e;
      ++count;
    }
    // The last block is filled up with copies of its last element.
    for (; last >= 0 && count % kPackSize != 0; ++count) {
      set_lane(table, last, count % kPackSize, part.blocks.back());
    }
    for (ShellBlock<A, Q>& block : part.blocks) {
      for (auto& nodes : block.nodes) {
        for (int& n : nodes) n = place_of[static_cast<std::size_t>(n)];
      }
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
void fill(SimdLevel level, const std::vector<ShellPart<A, Q>>& parts, const FourRow* rows,
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
  Eigen::Matrix3Xf preload;
  std::vector<ShellPart<4, 1>> linear;
  std::vector<ShellPart<10, 4>> quadratic;
  std::vector<int> node_order, vertex_order;  // (W), (V) along a space-filling curve
  std::vector<int> first;                     // (V + 1) in vertex_order
  std::vector<Term> terms;
  std::vector<FourRow> places;    // (W) m, displacements, in node_order
  std::vector<StressRow> stress;  // of all points, Pa

  Work(const ShellTable& table, int V)
      : vertices(V),
        preload(table.preload.cast<float>()),
        node_order(order_along_curve(table.stress_free)),
        vertex_order(order_along_curve(table.stress_free.leftCols(V))) {
    std::vector<int> place_of(node_order.size()), row_of_point;
    for (std::size_t k = 0; k < node_order.size(); ++k) {
      place_of[static_cast<std::size_t>(node_order[k])] = static_cast<int>(k);
    }
    const std::vector<int> elements = order_along_curve(middles_of(table));
    if (table.element_nodes == 4) {
      linear = parts_of<4, 1>(table, elements, place_of, row_of_point);
    } else {
      quadratic = parts_of<10, 4>(table, elements, place_of, row_of_point);
    }
    first.push_back(0);
    for (const int v : vertex_order) {
      const auto begin = static_cast<std::size_t>(table.first[static_cast<std::size_t>(v)]);
      const auto end = static_cast<std::size_t>(table.first[static_cast<std::size_t>(v) + 1]);
      for (std::size_t k = begin; k < end; ++k) {
        terms.push_back(
            {row_of_point[static_cast<std::size_t>(table.points[k])], table.weights[k]});
      }
      std::sort(terms.begin() + first.back(), terms.end(),
                [](const Term& a, const Term& b) { return a.point < b.point; });
      first.push_back(static_cast<int>(terms.size()));
    }
    places.assign(static_cast<std::size_t>(table.nodes()), FourRow{});
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
  for (std::size_t k = 0; k < w.places.size(); ++k) {
    const int n = w.node_order[k];
    const Eigen::Vector3f here = w.preload.col(n) + u.col(n);
    w.places[k].v = Four{here[0], here[1], here[2], 0.0f};
  }
  fill(w.level, w.linear, w.places.data(), w.stress.data());
  fill(w.level, w.quadratic, w.places.data(), w.stress.data());
  const Recovery recovery{w.vertex_order.data(), w.first.data(), w.terms.data(), w.vertices};
  const StressRow* rows = w.stress.data();
  float *to = von_mises.data(), *tensors = cauchy.empty() ? nullptr : cauchy.data();
  run_at<Recover>(w.level, recovery, rows, to, tensors);
}

}  // namespace palpable

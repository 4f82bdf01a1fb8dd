#include "palpable/solid/element_kernels.h"

#include <algorithm>
#include <limits>

namespace palpable {
namespace {

PALPABLE_ALWAYS_INLINE Pack gather(const double* field, const int (&n)[kPackSize], int i) {
  const double* const f = field + i;
  return Pack{f[3 * n[0]], f[3 * n[1]], f[3 * n[2]], f[3 * n[3]],
              f[3 * n[4]], f[3 * n[5]], f[3 * n[6]], f[3 * n[7]]};
}

// Entries [a][i] of a field at the nodes of a block.
template <int A>
struct NodeValues {
  Pack at[A][3];
};

template <int A, int Q>
PALPABLE_ALWAYS_INLINE void gather(const double* field, const ElementBlock<A, Q>& block,
                                   NodeValues<A>& values) {
  for (int a = 0; a < A; ++a) {
    for (int i = 0; i < 3; ++i) values.at[a][i] = gather(field, block.nodes[a], i);
  }
}

// Lane by lane, because two elements of a block may share a node.
template <int A, int Q>
PALPABLE_ALWAYS_INLINE void add_scattered(const NodeValues<A>& values,
                                          const ElementBlock<A, Q>& block, double* field) {
  for (int a = 0; a < A; ++a) {
    for (int lane = 0; lane < kPackSize; ++lane) {
      double* const at = field + 3 * block.nodes[a][lane];
      at[0] += values.at[a][0][lane];
      at[1] += values.at[a][1][lane];
      at[2] += values.at[a][2][lane];
    }
  }
}

// sum_a u_a (dN_a/dX)^T
template <int A, class Point>
PALPABLE_ALWAYS_INLINE Tensor<Pack> gradient(const NodeValues<A>& u, const Point& point) {
  Tensor<Pack> H;
  for (int J = 0; J < 3; ++J) {
    for (int i = 0; i < 3; ++i) {
      Pack sum = u.at[0][i] * point.g[0][J];
      for (int a = 1; a < A; ++a) sum += u.at[a][i] * point.g[a][J];
      H(i, J) = sum;
    }
  }
  return H;
}

template <int A, class Point>
PALPABLE_ALWAYS_INLINE Deformation<Pack> deformation_at(const NodeValues<A>& u,
                                                        const Point& point) {
  Tensor<Pack> F = gradient(u, point);
  for (int i = 0; i < 3; ++i) F(i, i) += 1.0;
  return deformation(F);
}

// values_a += P dN_a/dX
template <int A, class Point>
PALPABLE_ALWAYS_INLINE void add_divergence(const Tensor<Pack>& P, const Point& point,
                                           NodeValues<A>& values) {
  for (int a = 0; a < A; ++a) {
    for (int i = 0; i < 3; ++i) {
      values.at[a][i] +=
          P(i, 0) * point.g[a][0] + P(i, 1) * point.g[a][1] + P(i, 2) * point.g[a][2];
    }
  }
}

// The three passes; run() is compiled once for each level.

struct Forces {
  template <class Law, int A, int Q>
  PALPABLE_ALWAYS_INLINE static ForceSums run(const Law& law,
                                              std::span<const ElementBlock<A, Q>> blocks,
                                              const double* u, double* force) {
    Pack energy{}, smallest = Pack{} + std::numeric_limits<double>::infinity();
    PackBits smallest_block{}, inverted{};
    std::int64_t number = 0;
    for (const ElementBlock<A, Q>& block : blocks) {
      NodeValues<A> u_here, f_here{};
      gather(u, block, u_here);
      for (const auto& point : block.points) {
        const Deformation<Pack> d = deformation_at(u_here, point);
        const PackBits below = d.J < smallest;
        smallest = below ? d.J : smallest;
        smallest_block = below ? PackBits{} + number : smallest_block;
        inverted |= ~(d.J > 0.0);  // also when J is not a number
        energy += point.weight * energy_density(law, d);
        add_divergence(point.weight * first_piola(law, d), point, f_here);
      }
      add_scattered(f_here, block, force);
      ++number;
    }
    ForceSums sums;
    sums.smallest_volume_ratio = std::numeric_limits<double>::infinity();
    for (int lane = 0; lane < kPackSize; ++lane) {
      sums.energy += energy[lane];
      sums.inverted = sums.inverted || inverted[lane] != 0;
      if (smallest[lane] < sums.smallest_volume_ratio) {
        sums.smallest_volume_ratio = smallest[lane];
        sums.most_compressed = static_cast<int>(kPackSize * smallest_block[lane]) + lane;
      }
    }
    return sums;
  }
};

struct ForceChanges {
  template <class Law, int A, int Q>
  PALPABLE_ALWAYS_INLINE static int run(const Law& law, std::span<const ElementBlock<A, Q>> blocks,
                                        const double* u, const double* du, double* change) {
    for (const ElementBlock<A, Q>& block : blocks) {
      NodeValues<A> u_here, du_here, f_here{};
      gather(u, block, u_here);
      gather(du, block, du_here);
      for (const auto& point : block.points) {
        const Deformation<Pack> d = deformation_at(u_here, point);
        const Tensor<Pack> dP = first_piola_along(law, d, gradient(du_here, point));
        add_divergence(point.weight * dP, point, f_here);
      }
      add_scattered(f_here, block, change);
    }
    return 0;
  }
};

struct Tangents {
  template <class Law, int A, int Q>
  PALPABLE_ALWAYS_INLINE static int run(const Law& law, const ElementBlock<A, Q>& block,
                                        const double* u, ElementTangents<A>& tangents) {
    NodeValues<A> u_here;
    gather(u, block, u_here);
    tangents = {};
    for (const auto& point : block.points) {
      const Deformation<Pack> d = deformation_at(u_here, point);
      for (int b = 0; b < A; ++b) {
        for (int k = 0; k < 3; ++k) {
          Tensor<Pack> dF{};
          for (int J = 0; J < 3; ++J) dF(k, J) = point.g[b][J];
          const Tensor<Pack> dP = point.weight * first_piola_along(law, d, dF);
          for (int a = 0; a <= b; ++a) {
            for (int i = 0; i < 3; ++i) {
              tangents.K[a][b][i + 3 * k] +=
                  dP(i, 0) * point.g[a][0] + dP(i, 1) * point.g[a][1] + dP(i, 2) * point.g[a][2];
            }
          }
        }
      }
    }
    return 0;
  }
};

template <class Pass, class... Arguments>
auto run(SimdLevel level, const Material& material, Arguments&... arguments) {
  return std::visit([&](const auto& law) { return run_at<Pass>(level, law, arguments...); },
                    material);
}

}  // namespace

template <int A, int Q>
ForceSums add_forces(SimdLevel level, const Material& material,
                     std::span<const ElementBlock<A, Q>> blocks, const double* u, double* force) {
  return run<Forces>(level, material, blocks, u, force);
}

template <int A, int Q>
void add_force_changes(SimdLevel level, const Material& material,
                       std::span<const ElementBlock<A, Q>> blocks, const double* u,
                       const double* du, double* change) {
  run<ForceChanges>(level, material, blocks, u, du, change);
}

template <int A, int Q>
void element_tangents(SimdLevel level, const Material& material, const ElementBlock<A, Q>& block,
                      const double* u, ElementTangents<A>& tangents) {
  run<Tangents>(level, material, block, u, tangents);
}

#define PALPABLE_INSTANTIATE(A, Q)                                                              \
  template ForceSums add_forces<A, Q>(                                                          \
      SimdLevel, const Material&, std::span<const ElementBlock<A, Q>>, const double*, double*); \
  template void add_force_changes<A, Q>(SimdLevel, const Material&,                             \
                                        std::span<const ElementBlock<A, Q>>, const double*,     \
                                        const double*, double*);                                \
  template void element_tangents<A, Q>(SimdLevel, const Material&, const ElementBlock<A, Q>&,   \
                                       const double*, ElementTangents<A>&);
PALPABLE_INSTANTIATE(4, 1)
PALPABLE_INSTANTIATE(10, 4)
#undef PALPABLE_INSTANTIATE

}  // namespace palpable

#include "palpable/bake/solid/element_kernels.h"

#include "palpable/bake/solid/element_values.h"

#include <algorithm>
#include <limits>

namespace palpable {
namespace {

// A law that is called by function pointers. Its code is then compiled once for both element types,
// and not again inside each of their passes. It serves tangents, whose loops over the nodes are not
// worth unrolling, and processors without AVX2, for which inlined code would be twice as large as
// for all other levels.
struct CalledLaw {
  const Material& material;
  int (*density)(const Material&, const Deformation<Pack>&, Pack&);
  int (*piola)(const Material&, const Deformation<Pack>&, Tensor<Pack>&);
  int (*piola_along)(const Material&, const Deformation<Pack>&, const Tensor<Pack>&, Tensor<Pack>&);

  // The functions that law.h requires of a law.
  PALPABLE_ALWAYS_INLINE friend Pack energy_density(const CalledLaw& law,
                                                    const Deformation<Pack>& d) {
    Pack value;
    law.density(law.material, d, value);
    return value;
  }
  PALPABLE_ALWAYS_INLINE friend Tensor<Pack> first_piola(const CalledLaw& law,
                                                         const Deformation<Pack>& d) {
    Tensor<Pack> P;
    law.piola(law.material, d, P);
    return P;
  }
  PALPABLE_ALWAYS_INLINE friend Tensor<Pack> first_piola_along(const CalledLaw& law,
                                                               const Deformation<Pack>& d,
                                                               const Tensor<Pack>& dF) {
    Tensor<Pack> dP;
    law.piola_along(law.material, d, dF, dP);
    return dP;
  }
};

template <class Law>
struct LawDensity {
  PALPABLE_ALWAYS_INLINE static int run(const Material& material, const Deformation<Pack>& d,
                                        Pack& density) {
    density = energy_density(*std::get_if<Law>(&material), d);
    return 0;
  }
};
template <class Law>
struct LawPiola {
  PALPABLE_ALWAYS_INLINE static int run(const Material& material, const Deformation<Pack>& d,
                                        Tensor<Pack>& P) {
    P = first_piola(*std::get_if<Law>(&material), d);
    return 0;
  }
};
template <class Law>
struct LawPiolaAlong {
  PALPABLE_ALWAYS_INLINE static int run(const Material& material, const Deformation<Pack>& d,
                                        const Tensor<Pack>& dF, Tensor<Pack>& dP) {
    dP = first_piola_along(*std::get_if<Law>(&material), d, dF);
    return 0;
  }
};

CalledLaw called_law(SimdLevel level, const Material& material) {
  using At = const Deformation<Pack>;
  return std::visit(
      [&]<class Law>(const Law&) {
        return CalledLaw{
            material, function_at<LawDensity<Law>, const Material, At, Pack>(SimdLevel::kPlain),
            function_at<LawPiola<Law>, const Material, At, Tensor<Pack>>(SimdLevel::kPlain),
            function_at<LawPiolaAlong<Law>, const Material, At, const Tensor<Pack>, Tensor<Pack>>(
                level)};
      },
      material);
}

// The three passes over the elements. Their run() is compiled once for each level of instructions.

struct Forces {
  template <class Law, int A, int Q>
  PALPABLE_ALWAYS_INLINE static ForceSums run(const Law& law,
                                              std::span<const ElementBlock<A, Q>> blocks,
                                              const NodeRow* rows, NodeSum* forces) {
    Pack energy{}, smallest = Pack{} + std::numeric_limits<double>::infinity();
    PackBits smallest_block{}, inverted{};
    std::int64_t number = 0;
    for (const ElementBlock<A, Q>& block : blocks) {
      NodeValues<A> u_here, f_here{};
      gather_differences<&NodeRow::u>(rows, block, u_here);
      for (const auto& point : block.points) {
        const Deformation<Pack> d = deformation_at(u_here, point);
        const PackBits below = d.J < smallest;
        smallest = below ? d.J : smallest;
        smallest_block = below ? PackBits{} + number : smallest_block;
        inverted |= ~(d.J > 0.0);  // also when J is not a number
        energy += point.weight * energy_density(law, d);
        add_divergence(point.weight * first_piola(law, d), point, f_here);
      }
      add_scattered(f_here, block, forces);
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
                                        const NodeRow* rows, NodeSum* changes) {
    for (const ElementBlock<A, Q>& block : blocks) {
      NodeValues<A> u_here, du_here, f_here{};
      gather_differences<&NodeRow::u>(rows, block, u_here);
      gather_differences<&NodeRow::du>(rows, block, du_here);
      for (const auto& point : block.points) {
        const Deformation<Pack> d = deformation_at(u_here, point);
        const Tensor<Pack> dP = first_piola_along(law, d, gradient(du_here, point));
        add_divergence(point.weight * dP, point, f_here);
      }
      add_scattered(f_here, block, changes);
    }
    return 0;
  }
};

struct Tangents {
  template <int A, int Q>
  PALPABLE_ALWAYS_INLINE static int run(const CalledLaw& law, const ElementBlock<A, Q>& block,
                                        const NodeRow* rows, ElementTangents<A>& tangents) {
    NodeValues<A> u_here;
    gather_differences<&NodeRow::u>(rows, block, u_here);
    tangents = {};
    for (const auto& point : block.points) {
      const Deformation<Pack> d = deformation_at(u_here, point);
      Pack g[A][3];
      for (int J = 0; J < 3; ++J) {
        g[0][J] = Pack{};
        for (int a = 1; a < A; ++a) {
          g[a][J] = point.g[a - 1][J];
          g[0][J] -= g[a][J];
        }
      }
      for (int b = 0; b < A; ++b) {
        for (int k = 0; k < 3; ++k) {
          Tensor<Pack> dF{};
          for (int J = 0; J < 3; ++J) dF(k, J) = g[b][J];
          const Tensor<Pack> dP = point.weight * first_piola_along(law, d, dF);
          for (int a = 0; a <= b; ++a) {
            for (int i = 0; i < 3; ++i) {
              tangents.K[a][b][i + 3 * k] +=
                  dP(i, 0) * g[a][0] + dP(i, 1) * g[a][1] + dP(i, 2) * g[a][2];
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
  if (level == SimdLevel::kPlain) {
    const CalledLaw law = called_law(level, material);
    return run_plain<Pass>(law, arguments...);
  }
  return std::visit([&](const auto& law) { return run_with_avx<Pass>(level, law, arguments...); },
                    material);
}

}  // namespace

template <int A, int Q>
ForceSums add_forces(SimdLevel level, const Material& material,
                     std::span<const ElementBlock<A, Q>> blocks, const NodeRow* rows,
                     NodeSum* forces) {
  return run<Forces>(level, material, blocks, rows, forces);
}

template <int A, int Q>
void add_force_changes(SimdLevel level, const Material& material,
                       std::span<const ElementBlock<A, Q>> blocks, const NodeRow* rows,
                       NodeSum* changes) {
  run<ForceChanges>(level, material, blocks, rows, changes);
}

template <int A, int Q>
void element_tangents(SimdLevel level, const Material& material, const ElementBlock<A, Q>& block,
                      const NodeRow* rows, ElementTangents<A>& tangents) {
  const CalledLaw law = called_law(level, material);
  run_at<Tangents>(level, law, block, rows, tangents);
}

#define PALPABLE_INSTANTIATE(A, Q)                                                                \
  template ForceSums add_forces<A, Q>(                                                            \
      SimdLevel, const Material&, std::span<const ElementBlock<A, Q>>, const NodeRow*, NodeSum*); \
  template void add_force_changes<A, Q>(                                                          \
      SimdLevel, const Material&, std::span<const ElementBlock<A, Q>>, const NodeRow*, NodeSum*); \
  template void element_tangents<A, Q>(SimdLevel, const Material&, const ElementBlock<A, Q>&,     \
                                       const NodeRow*, ElementTangents<A>&);
PALPABLE_INSTANTIATE(4, 1)
PALPABLE_INSTANTIATE(10, 4)
#undef PALPABLE_INSTANTIATE

}  // namespace palpable

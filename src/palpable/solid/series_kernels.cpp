#include "palpable/solid/series_kernels.h"

#include "palpable/base/contract.h"
#include "palpable/solid/element_values.h"
#include "palpable/solid/jet.h"

#include <variant>

namespace palpable {
namespace {

// Both orders come from one pass, so that it is compiled once: the third costs a third more time.
struct ForceTerm {
  using Series = Jet<Pack, 3>;

  template <class Law, int A, int Q>
  PALPABLE_ALWAYS_INLINE static int run(const Law& law, std::span<const ElementBlock<A, Q>> blocks,
                                        const int& order, const SeriesRow* rows, NodeSum* sums) {
    for (const ElementBlock<A, Q>& block : blocks) {
      NodeValues<A> base, first, second, f_here{};
      gather_differences<&SeriesRow::base>(rows, block, base);
      gather_differences<&SeriesRow::first>(rows, block, first);
      gather_differences<&SeriesRow::second>(rows, block, second);
      for (const auto& point : block.points) {
        const Tensor<Pack> H0 = gradient(base, point), H1 = gradient(first, point);
        const Tensor<Pack> H2 = gradient(second, point);
        Tensor<Series> F{};
        for (int k = 0; k < 9; ++k) {
          F.m[k].c[0] = H0.m[k];
          F.m[k].c[1] = H1.m[k];
          if (order > 2) F.m[k].c[2] = H2.m[k];
        }
        for (int i = 0; i < 3; ++i) F(i, i) += 1.0;
        const Tensor<Series> P = first_piola(law, deformation(F));
        Tensor<Pack> term;
        for (int k = 0; k < 9; ++k) {
          term.m[k] = point.weight * (order == 2 ? P.m[k].c[2] : P.m[k].c[3]);
        }
        add_divergence(term, point, f_here);
      }
      add_scattered(f_here, block, sums);
    }
    return 0;
  }
};

}  // namespace

template <int A, int Q>
void add_force_term(SimdLevel level, const Material& material,
                    std::span<const ElementBlock<A, Q>> blocks, int order, const SeriesRow* rows,
                    NodeSum* sums) {
  PALPABLE_EXPECT(order == 2 || order == 3, "terms of order 2 and 3 are written");
  std::visit([&](const auto& law) { run_at<ForceTerm>(level, law, blocks, order, rows, sums); },
             material);
}

template void add_force_term<4, 1>(SimdLevel, const Material&, std::span<const ElementBlock<4, 1>>,
                                   int, const SeriesRow*, NodeSum*);
template void add_force_term<10, 4>(SimdLevel, const Material&,
                                    std::span<const ElementBlock<10, 4>>, int, const SeriesRow*,
                                    NodeSum*);

}  // namespace palpable

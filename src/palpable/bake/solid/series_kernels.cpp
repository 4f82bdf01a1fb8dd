#include "palpable/bake/solid/series_kernels.h"

#include "palpable/bake/solid/element_values.h"
#include "palpable/bake/solid/jet.h"
#include "palpable/common/base/contract.h"

#include <variant>

namespace palpable {
namespace {

using SeriesPack = Jet<Pack, 3>;

// The law's part: P of order 2 or 3 along F. It is most of the code, so it is a function of its
// own, which elements of both shapes call. Both orders come from one pass, so that it is compiled
// once: the third costs a third more time.
template <class Law>
struct LawTerm {
  PALPABLE_ALWAYS_INLINE static int run(const Material& material, const Tensor<SeriesPack>& F,
                                        const int& order, Tensor<Pack>& term) {
    const Tensor<SeriesPack> P = first_piola(*std::get_if<Law>(&material), deformation(F));
    for (int k = 0; k < 9; ++k) term.m[k] = order == 2 ? P.m[k].c[2] : P.m[k].c[3];
    return 0;
  }
};
using LawTermFunction = int (*)(const Material&, const Tensor<SeriesPack>&, const int&,
                                Tensor<Pack>&);

LawTermFunction law_term(SimdLevel level, const Material& material) {
  return std::visit(
      [level]<class Law>(const Law&) -> LawTermFunction {
        return function_at<LawTerm<Law>, const Material, const Tensor<SeriesPack>, const int,
                           Tensor<Pack>>(level);
      },
      material);
}

struct ForceTerm {
  template <int A, int Q>
  PALPABLE_ALWAYS_INLINE static int run(const Material& material,
                                        const LawTermFunction& term_of_law,
                                        std::span<const ElementBlock<A, Q>> blocks,
                                        const int& order, const SeriesRow* rows, NodeSum* sums) {
    for (const ElementBlock<A, Q>& block : blocks) {
      NodeValues<A> base, first, second, f_here{};
      gather_differences<&SeriesRow::base>(rows, block, base);
      gather_differences<&SeriesRow::first>(rows, block, first);
      gather_differences<&SeriesRow::second>(rows, block, second);
      for (const auto& point : block.points) {
        const Tensor<Pack> H0 = gradient(base, point), H1 = gradient(first, point);
        const Tensor<Pack> H2 = gradient(second, point);
        Tensor<SeriesPack> F{};
        for (int k = 0; k < 9; ++k) {
          F.m[k].c[0] = H0.m[k];
          F.m[k].c[1] = H1.m[k];
          if (order > 2) F.m[k].c[2] = H2.m[k];
        }
        for (int i = 0; i < 3; ++i) F(i, i) += 1.0;
        Tensor<Pack> term;
        term_of_law(material, F, order, term);
        add_divergence(point.weight * term, point, f_here);
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
  const LawTermFunction term_of_law = law_term(level, material);
  run_at<ForceTerm>(level, material, term_of_law, blocks, order, rows, sums);
}

template void add_force_term<4, 1>(SimdLevel, const Material&, std::span<const ElementBlock<4, 1>>,
                                   int, const SeriesRow*, NodeSum*);
template void add_force_term<10, 4>(SimdLevel, const Material&,
                                    std::span<const ElementBlock<10, 4>>, int, const SeriesRow*,
                                    NodeSum*);

}  // namespace palpable

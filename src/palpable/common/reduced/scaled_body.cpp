#include "palpable/common/reduced/scaled_body.h"

#include "palpable/common/base/contract.h"

#include <cmath>

namespace palpable {

ReducedBody scaled(const ReducedBody& body, double factor) {
  PALPABLE_EXPECT(factor > 0 && std::isfinite(factor), "a size is a number above 0");
  ReducedBody result = body;
  result.surface.vertices *= factor;
  const auto larger = [&](const SeparatedField& u) {
    return SeparatedField(u.modes() * static_cast<float>(factor), u.axes());
  };
  result.displacement = larger(body.displacement);
  result.press_depth *= factor;
  result.depth_slope *= factor;
  result.level_slope /= factor;
  result.further_press_depth *= factor;
  result.further_full_load *= factor * factor;
  if (result.volume) {
    result.volume->nodes *= factor;
    result.volume->displacement = larger(body.volume->displacement);
  }
  for (Site& site : result.sites) site.full_load *= factor * factor;
  if (result.several) {
    SeveralLoads& several = *result.several;
    // The strains are the same, and the volume is factor^3 times as large.
    for (auto* coefficients : {&several.energy.C, &several.energy.D}) {
      *coefficients *= factor * factor * factor;
    }
    several.energy.K *= factor * factor * factor;
    several.modes *= static_cast<float>(factor);
    for (Site& site : several.reactions) site.full_load *= factor * factor;
  }
  result.provenance.scaled_by = factor * body.provenance.scaled_by.value_or(1.0);
  return result;
}

}  // namespace palpable

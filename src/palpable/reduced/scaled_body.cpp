#include "palpable/reduced/scaled_body.h"

#include "palpable/base/contract.h"

#include <fmt/core.h>

#include <cmath>

namespace palpable {

ReducedBody scaled(const ReducedBody& body, double factor) {
  PALPABLE_EXPECT(factor > 0 && std::isfinite(factor), "a size is a number above 0");
  ReducedBody result = body;
  result.surface.vertices *= factor;
  result.displacement = SeparatedField(body.displacement.modes() * static_cast<float>(factor),
                                       body.displacement.axes());
  result.press_depth *= factor;
  for (Site& site : result.sites) site.full_load *= factor * factor;
  result.provenance.emplace_back("scaled by", fmt::format("{}", factor));
  return result;
}

}  // namespace palpable

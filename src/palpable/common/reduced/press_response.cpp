#include "palpable/common/reduced/press_response.h"

#include "palpable/common/base/contract.h"

#include <algorithm>
#include <array>

namespace palpable {
namespace {

PressResponse under_one(const ReducedBody& body, const PlacedLoad& load) {
  const std::array<double, 2> mu{static_cast<double>(load.place), load.level};
  PressResponse response{{press_depth_of_level(body, load.place, load.level)},
                         std::vector<float>(body.displacement.value_count()),
                         {},
                         body.error.displacement_worst};
  std::vector<float> stress(2 * response.displacement.size()), of_mises(stress.size() / 6);
  body.displacement.evaluate(mu, response.displacement);
  body.stress.evaluate(mu, stress);
  von_mises(stress, of_mises);
  response.largest_von_mises = *std::max_element(of_mises.begin(), of_mises.end());
  return response;
}

PressResponse under_several(const ReducedBody& body, std::span<const PlacedLoad> loads) {
  LoadedBody loaded = value_or_throw(LoadedBody::make(body));
  const LoadedBody::Answer found = loaded.solve(loads);
  if (!found.ok()) throw Error(refusal_text(body, found, loads));
  PressResponse response;
  response.displacement.resize(body.displacement.value_count());
  loaded.displacement(response.displacement);
  for (const PlacedLoad& load : loads) response.depth.push_back(loaded.press_depth(load.place));
  response.error = body.several->error_worst;
  return response;
}

}  // namespace

PressResponse find_press_response(const ReducedBody& body, std::span<const PlacedLoad> loads) {
  PALPABLE_EXPECT(!loads.empty(), "there is at least one load");
  const bool at_one_site = loads.size() == 1 && loads[0].place < std::ssize(body.sites);
  return at_one_site ? under_one(body, loads[0]) : under_several(body, loads);
}

}  // namespace palpable

#include "apps/palpable/named_loads.h"

#include "palpable/common/base/error.h"
#include "palpable/common/base/text_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace palpable::app {

std::vector<PlacedLoad> parse_loads(const ReducedBody& body,
                                    const std::vector<std::string>& texts) {
  std::vector<PlacedLoad> loads;
  for (const std::string& text : texts) {
    const std::size_t equals = std::min(text.find('='), text.size());
    const auto place = to_numbers(std::string_view(text).substr(0, equals));
    const auto force = to_numbers(std::string_view(text).substr(equals + (equals < text.size())));
    if (!place || place->size() != 3 || !force || force->size() != 1) {
      throw Error(
          fmt::format("--load {}: wants X,Y,Z=F in m and N, finite numbers such as "
                      "0,0.02,0.05=1.5",
                      text));
    }
    const Eigen::Vector3d X((*place)[0], (*place)[1], (*place)[2]);
    const Result<PlacedLoad> load = load_at(body, X, force->front());
    if (!load.ok()) throw Error(fmt::format("--load {}: {}", text, load.problem().message));
    loads.push_back(load.value());
  }
  return loads;
}

}  // namespace palpable::app

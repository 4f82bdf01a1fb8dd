#include "apps/palpable/named_loads.h"

#include "palpable/base/error.h"

#include <fmt/format.h>

#include <cstdio>

namespace palpable::app {

std::vector<PlacedLoad> parse_loads(const ReducedBody& body,
                                    const std::vector<std::string>& texts) {
  std::vector<PlacedLoad> loads;
  for (const std::string& text : texts) {
    Eigen::Vector3d X;
    double force = 0;
    int read = 0;
    if (std::sscanf(text.c_str(), "%lf,%lf,%lf=%lf%n", &X[0], &X[1], &X[2], &force, &read) != 4 ||
        read != static_cast<int>(text.size())) {
      throw Error(
          fmt::format("--load {}: wants X,Y,Z=F in m and N, for example 0,0.02,0.05=1.5", text));
    }
    const Result<PlacedLoad> load = load_at(body, X, force);
    if (!load.ok()) throw Error(fmt::format("--load {}: {}", text, load.problem().message));
    loads.push_back(load.value());
  }
  return loads;
}

}  // namespace palpable::app

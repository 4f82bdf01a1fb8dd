#include "apps/palpable/default_body.h"

#include "palpable/base/error.h"

#include <fmt/core.h>

#include <array>

namespace palpable::app {

std::filesystem::path default_body() {
  constexpr std::array kBodies = {"build/bodies/bunny-dense.palpable", "out/demo/bunny.palpable"};
  for (const char* body : kBodies) {
    if (std::filesystem::exists(body)) return body;
  }
  throw Error(fmt::format("neither {} nor {} is there; bake one, or give --body FILE", kBodies[0],
                          kBodies[1]));
}

}  // namespace palpable::app

#include "palpable/bake/law_constants.h"

#include "palpable/base/error.h"
#include "tests/support/test.h"

namespace palpable {
namespace {

using test::tolerance;

TEST_CASE("every law's own constants make the material that Young's modulus makes",
          "[bake][material]") {
  for (const std::string& law : law_names()) {
    INFO(law);
    const Material material = material_from_young(law, 60e3, 0.35);
    const std::vector<double> constants = constants_of(material);
    REQUIRE(constants.size() == law_constants(law).size());
    const Material again = material_from_constants(law, constants);
    CHECK(law_name(again) == law);
    CHECK(constants_of(again) == constants);
    const auto [young, poisson] = young_poisson(again);
    CHECK(young == Approx(60e3).epsilon(tolerance(1e-12, "rounding")));
    CHECK(poisson == Approx(0.35).epsilon(tolerance(1e-12, "rounding")));
  }
  CHECK_THROWS_AS(material_from_constants("neo-hookean", {-1.0, 1.0}), Error);
}

}  // namespace
}  // namespace palpable

#include "bench/bake/touch_study.h"

#include "palpable/bake/touch_bake/compliance_maker.h"
#include "tests/support/standing_rubber.h"
#include "tests/support/test.h"

namespace palpable {
namespace {

using test::tolerance;

TEST_CASE("the table of a block's compliance leaves little out", "[bench][touch]") {
  const SolidModel model =
      test::standing_rubber(box_tets({-0.03, -0.025, 0}, {0.03, 0.025, 0.04}, 10, 8, 7));
  const SkinResponse skin(model, boundary_of(model.mesh));
  const ComplianceTable table = make_compliance(skin, {.threads = 2});
  const Compliance compliance(table);
  for (const double error : compliance_errors(skin, compliance, 10, 1)) {
    CHECK(error > 0);
    CHECK(error < tolerance(3e-3, "32 of up to 81 columns of a cluster; 16 bits"));
  }
}

}  // namespace
}  // namespace palpable

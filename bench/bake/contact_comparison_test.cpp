#include "bench/bake/contact_comparison.h"

#include "palpable/bake/calculix/calculix.h"
#include "tests/support/test.h"

namespace palpable {
namespace {

using test::tolerance;

TEST_CASE("CalculiX' penalty contact approaches ours as it stiffens", "[contact][calculix]") {
  if (!find_calculix()) PALPABLE_SKIP("CalculiX (ccx, Debian calculix-ccx) is not installed");
  const std::vector<ContactDifference> found = compare_contact(5, {10, 100, 1000});
  REQUIRE(found.size() == 3);
  for (std::size_t i = 0; i < found.size(); ++i) {
    INFO(found[i].stiffness << ": " << found[i].displacement << ", " << found[i].force);
    if (i > 0) CHECK(found[i].displacement < 0.3 * found[i - 1].displacement);
    if (i > 0) CHECK(found[i].force < 0.3 * found[i - 1].force);
  }
  CHECK(found.back().displacement <= tolerance(0.01, "issue 24"));
  CHECK(found.back().force <= tolerance(0.01, "issue 24"));
}

}  // namespace
}  // namespace palpable

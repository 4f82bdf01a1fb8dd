#include "palpable/bake/pipeline/bake_body.h"
#include "tests/support/egg_body.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

namespace palpable {
namespace {

TEST_CASE("a baked body states the error of touches between its sites, which falls with more sites",
          "[pipeline][between]") {
  const test::ScratchFolder folder("between");
  test::write_egg(folder.path(), 3);
  BodyDescription description = test::egg_description(folder.path(), 2);
  description.press = {.depth = 0.02, .levels = 2};
  const auto baked = [&](int count, bool linear) {
    description.sites = {.count = count, .above = 0.3, .patch = 1, .linear = linear};
    return bake_body(description, {.threads = 1, .version = {}, .command_line = {}});
  };
  const BakedBody few = baked(4, false), many = baked(40, false);
  REQUIRE(few.body.error.between_sites.has_value());
  REQUIRE(many.body.error.between_sites.has_value());
  CHECK(few.body.error.between_sites.value() > 1.5 * many.body.error.between_sites.value());
  CHECK(
      (many.body.error.between_sites.value() > 0.01 && few.body.error.between_sites.value() < 1.5));
  CHECK_FALSE(few.report.between_sites.empty());
  // With all linear responses, or only those that are needed, the touches and the error are the
  // same.
  CHECK(baked(4, true).body.error.between_sites.value() == few.body.error.between_sites.value());
  CHECK_FALSE(baked(1, false).body.error.between_sites.has_value());
}

}  // namespace
}  // namespace palpable

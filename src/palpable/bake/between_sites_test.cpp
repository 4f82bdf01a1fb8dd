#include "palpable/bake/bake_body.h"
#include "palpable/geometry/mesh_file.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

namespace palpable {
namespace {

TEST_CASE("a baked body says what a touch between its sites costs, and less with more sites",
          "[bake][between]") {
  const test::ScratchFolder folder("between");
  SurfaceMesh egg = sphere_surface({0, 0, 0}, 1, 3);
  egg.vertices.row(1) *= 1.3;
  write_ply(folder / "egg.ply", egg);
  BodyDescription description;
  description.name = "egg";
  description.source = folder / "egg.toml";
  description.shape = {.file = folder / "egg.ply", .up = UpAxis::kY, .height = 0.08, .edge = {}};
  description.material = {.law = "neo-hookean", .young = 40e3, .poisson = 0.35};
  description.supports = {{.where = {Where::Below{0.15}, "egg.toml:9: 'below' in [support]"}}};
  description.supports_place = "egg.toml:8: [support]";
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
  // All responses, or those that are needed: the same touches and the same figure.
  CHECK(baked(4, true).body.error.between_sites.value() == few.body.error.between_sites.value());
  CHECK_FALSE(baked(1, false).body.error.between_sites.has_value());
}

}  // namespace
}  // namespace palpable

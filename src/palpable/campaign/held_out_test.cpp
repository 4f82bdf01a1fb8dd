#include "palpable/campaign/held_out.h"

#include "palpable/bake/bake_body.h"
#include "palpable/base/error.h"
#include "palpable/campaign/crew.h"
#include "palpable/describe/body_mesh.h"
#include "palpable/geometry/mesh_file.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <array>
#include <cmath>
#include <filesystem>
#include <vector>

namespace palpable {
namespace {

using test::tolerance;

BodyDescription egg(const std::filesystem::path& folder, int levels) {
  SurfaceMesh surface = sphere_surface({0, 0, 0}, 1, 2);
  surface.vertices.row(1) *= 1.3;
  write_ply(folder / "egg.ply", surface);
  BodyDescription body;
  body.name = "egg";
  body.source = folder / "egg.toml";
  body.shape = {.file = folder / "egg.ply", .up = UpAxis::kY, .height = 0.08, .edge = {}};
  body.material = {.law = "neo-hookean", .young = 40e3, .poisson = 0.35};
  body.supports = {{.where = {Where::Below{0.15}, "egg.toml:9: 'below' in [support]"}}};
  body.supports_place = "egg.toml:8: [support]";
  body.sites = {.count = 2, .above = 0.4, .patch = 1};
  body.press = {.depth = 0.06, .levels = levels};
  return body;
}

SnapshotStore solved(const BodyDescription& body, const std::filesystem::path& folder,
                     const SnapshotStore* held_out_of = nullptr) {
  LocalCrew crew;
  BakeSettings settings;
  settings.threads = 1;
  settings.store = folder;
  settings.held_out_of = held_out_of;
  return fill_store(body, settings, crew).store;
}

TEST_CASE("levels between are solved under the loads of the campaign", "[bake][heldout]") {
  const test::ScratchFolder scratch("held-out");
  const BodyDescription body = egg(scratch.path(), 2);
  const SnapshotStore campaign = solved(body, scratch.path() / "campaign");
  const SnapshotStore between = solved(body, scratch.path() / "between", &campaign);
  REQUIRE(between.content().level_count() == 2);
  CHECK(between.content().levels[1] == 0.25);
  CHECK(between.content().levels[2] == 0.75);
  // Of a campaign with twice the levels, every other level is the same state.
  const SnapshotStore fine = solved(egg(scratch.path(), 4), scratch.path() / "fine");
  const StoredField& moved = between.content().fields[0];
  const Eigen::Index rows = 3 * between.content().mesh.node_count();
  for (int s = 0; s < 2; ++s) {
    CHECK(std::abs(between.unit(s).full_load - campaign.unit(s).full_load) == 0.0);
    const Eigen::MatrixXf a = between.rows(s, moved, 0, rows), b = fine.rows(s, moved, 0, rows);
    for (const int l : {0, 1}) {
      CHECK((a.col(l) - b.col(2 * l)).norm() <=
            tolerance(1e-4f, "the load of a press is found to three digits and then kept") *
                b.col(2 * l).norm());
      CHECK(std::abs(between.unit(s).press_depth[l + 1] / fine.unit(s).press_depth[2 * l + 1] -
                     1) <= tolerance(1e-4, "likewise"));
    }
  }
  CHECK_THROWS_AS(solved(egg(scratch.path(), 3), scratch.path() / "other", &campaign), Error);
}

TEST_CASE("a body's errors between its levels are those of what the live half evaluates",
          "[bake][heldout]") {
  const test::ScratchFolder scratch("held-out");
  const BodyDescription body = egg(scratch.path(), 5);
  const SnapshotStore campaign = solved(body, scratch.path() / "campaign");
  const SnapshotStore between = solved(body, scratch.path() / "between", &campaign);
  const ReducedBody reduced = reduce_store(campaign, {}).body;
  const HeldOutErrors errors = held_out_errors(reduced, between);
  REQUIRE(errors.displacement.rows() == 5);
  REQUIRE(errors.displacement.cols() == 2);
  // Against its own levels nothing is left but the reduction's 1e-4.
  const HeldOutErrors own = held_out_errors(reduced, campaign);
  CHECK(own.displacement.maxCoeff() <=
        tolerance(3e-4, "1e-4 in the mean over the volume; this is the worst, over the skin"));
  CHECK(own.von_mises.maxCoeff() <= tolerance(3e-3, "likewise, and one vertex"));
  CHECK(errors.displacement_pooled <= errors.displacement.maxCoeff());
  CHECK(errors.displacement_median() <= errors.displacement.maxCoeff());
  CHECK(errors.displacement.maxCoeff() <=
        tolerance(2e-2, "cubics through five levels, the lowest a tenth of the load"));
  // One mode a site is a straight line in the space of fields: visibly worse.
  const ReducedBody poor = reduce_store(campaign, {.max_modes = 1}).body;
  CHECK(held_out_errors(poor, between).displacement_pooled > 3.0 * errors.displacement_pooled);
  const HeldOutRecord record = errors.record();
  CHECK((record.levels - Eigen::VectorXd::LinSpaced(5, 0.1, 0.9)).cwiseAbs().maxCoeff() <=
        tolerance(1e-15, "rounding of sums of 0.2"));
  CHECK(record.displacement == errors.displacement.cast<float>());
  CHECK(record.displacement_pooled == errors.displacement_pooled);
  CHECK(record.von_mises == errors.von_mises.cast<float>());
  // By hand, one snapshot.
  const Eigen::VectorXd areas = vertex_areas(reduced.surface);
  const Boundary boundary = split_boundary_of(between.content().mesh);
  const Eigen::MatrixXf all =
      between.rows(1, between.content().fields[0], 0, 3 * between.content().mesh.node_count());
  std::vector<float> u(static_cast<std::size_t>(reduced.displacement.value_count()));
  reduced.displacement.evaluate(std::array{1.0, 0.7}, u);
  double lost = 0, whole = 0;
  for (std::size_t v = 0; v < boundary.node_of_vertex.size(); ++v) {
    for (std::size_t c = 0; c < 3; ++c) {
      const double truth = all(3 * boundary.node_of_vertex[v] + static_cast<int>(c), 3);
      const double area = areas[static_cast<Eigen::Index>(v)];
      lost += area * (u[3 * v + c] - truth) * (u[3 * v + c] - truth);
      whole += area * truth * truth;
    }
  }
  CHECK(std::abs(std::sqrt(lost / whole) - errors.displacement(3, 1)) <=
        tolerance(1e-9, "rounding"));
}

}  // namespace
}  // namespace palpable

#include "palpable/bake/campaign/held_out.h"
#include "palpable/bake/pipeline/bake_body.h"
#include "tests/support/egg_body.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <array>
#include <cmath>
#include <vector>

namespace palpable {
namespace {

using test::egg_body;
using test::solved_store;
using test::tolerance;

TEST_CASE("a body's errors between its levels are those of what the live half evaluates",
          "[pipeline][heldout]") {
  const test::ScratchFolder scratch("held-out");
  const BodyDescription body = egg_body(scratch.path(), 5);
  const SnapshotStore campaign = solved_store(body, scratch.path() / "campaign");
  const SnapshotStore between = solved_store(body, scratch.path() / "between", &campaign);
  const ReducedBody reduced = reduce_store(campaign, {}).body;
  const HeldOutErrors errors = held_out_errors(reduced, between);
  REQUIRE(errors.displacement.rows() == 5);
  REQUIRE(errors.displacement.cols() == 2);
  // At its own levels the error is that of the reduction alone, 1e-4.
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
  // One snapshot, computed by hand.
  const Eigen::VectorXd areas = vertex_areas(reduced.surface);
  const Boundary boundary = split_boundary_of(between.content().mesh);
  const Eigen::MatrixXf all =
      between.rows(1, between.content().fields[0], 0, 3 * between.content().mesh.node_count());
  std::vector<float> u(reduced.displacement.value_count());
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

#include "palpable/bake/intrusive/intrusive_bake.h"

#include "palpable/bake/solid/equilibrium.h"
#include "palpable/bake/solid/stress.h"
#include "palpable/common/base/error.h"
#include "palpable/common/body_file/body_file.h"
#include "tests/support/beam_description.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <array>
#include <cmath>
#include <string>

namespace palpable {
namespace {

using Catch::Matchers::Contains;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::tolerance;

TEST_CASE("a beam baked by intrusive PGD gives the fields of fresh Newton solves", "[intrusive]") {
  const test::ScratchFolder folder("intrusive");
  const BodyDescription description = test::describe_small_beam(
      folder.path(),
      "[intrusive]\npositions = [\"TOP\"]\nforce = \"2 N\"\nmodes = 24\nstress_modes = 60\n");
  const IntrusiveBake made =
      bake_intrusive(description, {.version = "test", .command_line = "none"});
  CHECK(made.travelling.left_out > 0);
  CHECK(made.report.modes == 24);
  CHECK(made.report.displacement.worst < tolerance(0.02, "24 modes of a coarse beam"));
  CHECK(made.report.displacement.global < made.report.displacement.worst);

  // As the live half reads it.
  write_body_file(folder.path() / "beam.palpable", made.body);
  const ReducedBody body = value_or_throw(read_pressable_body(folder.path() / "beam.palpable"));
  const Boundary& boundary = made.travelling.problem.mesh.boundary;
  const auto V = static_cast<Index>(body.surface.vertex_count());
  const EquilibriumSolver newton(made.travelling.problem.model);
  std::vector<float> u(3 * V), sigma(6 * V);
  for (const int site : {0, 17, 40, static_cast<int>(body.sites.size()) - 1}) {
    for (const double level : {0.37, 1.0}) {
      INFO("site " << site << " level " << level);
      const std::array<double, 2> mu{static_cast<double>(site), level};
      body.displacement.evaluate(mu, u);
      body.stress.evaluate(mu, sigma);
      const VectorXd f = made.travelling.load.col(site);
      const PathResult path =
          newton.solve_path(f.reshaped(3, f.size() / 3), std::array<double, 1>{level});
      REQUIRE(path.complete);
      const Eigen::Matrix3Xd truth =
          path.steps[0].displacement(Eigen::all, boundary.node_of_vertex);
      const StressField true_stress =
          nodal_cauchy_stress(made.travelling.problem.model, path.steps[0].displacement)(
              Eigen::all, boundary.node_of_vertex);
      const Eigen::Map<const Eigen::Matrix3Xf> got(u.data(), 3, V);
      const Eigen::Map<const Eigen::Matrix<float, 6, Eigen::Dynamic>> got_stress(sigma.data(), 6,
                                                                                 V);
      CHECK((got.cast<double>() - truth).norm() <=
            1.5 * made.report.displacement.worst * truth.norm());
      CHECK((got_stress.cast<double>() - true_stress).norm() <=
            1.5 * made.report.stress_worst * true_stress.norm());
      // The patch has moved by the press depth that the file states.
      const Site& at = body.sites[site];
      double press = 0;
      for (std::size_t k = 0; k < at.patch.size(); ++k) {
        press += static_cast<double>(at.weights[k]) * at.direction.dot(truth.col(at.patch[k]));
      }
      CHECK(press_depth_of_level(body, site, level) ==
            Approx(press).epsilon(tolerance(1e-3, "a cubic between six load sizes")));
      CHECK(at.full_load == Approx(2.0));
    }
  }
  CHECK(made.report.stress_worst < tolerance(0.2, "60 modes of stress"));
}

TEST_CASE("what an intrusive bake cannot do is refused in one line", "[intrusive]") {
  const test::ScratchFolder folder("intrusive");
  const auto refusal = [&](const std::string& intrusive) {
    try {
      (void)bake_intrusive(test::describe_small_beam(folder.path(), intrusive), {});
    } catch (const Error& error) { return std::string(error.what()); }
    return std::string("nothing was refused");
  };
  CHECK_THAT(refusal(""), Contains("[intrusive]") && Contains("docs/body.md"));
  CHECK_THAT(refusal("[intrusive]\npositions = [\"TPO\"]\nforce = \"2 N\"\n"), Contains("TOP"));
  CHECK_THAT(refusal("[intrusive]\npositions = [\"CLAMP\"]\nforce = \"2 N\"\n"),
             Contains("moves nothing"));
  CHECK_THAT(refusal("[intrusive]\npositions = [\"TOP\"]\nforce = \"2 N\"\nclearance = 90\n"),
             Contains("no position is left") && Contains("clearance"));
  CHECK_THAT(refusal("[intrusive]\npositions = [\"TOP\"]\nforce = \"20 N\"\n"),
             Contains("20 N") && Contains("the range of the model"));
  CHECK_THAT(refusal("[intrusive]\npositions = [\"TOP\"]\n"), Contains("force"));
  CHECK_THAT(refusal("[intrusive]\npositions = [\"TOP\"]\nforce = \"2 N\"\nmods = 3\n"),
             Contains("modes"));
  CHECK_THAT(refusal("[gravity]\ndensity = \"1000 kg/m^3\"\n"
                     "[intrusive]\npositions = [\"TOP\"]\nforce = \"2 N\"\n"),
             Contains("weight"));
}

}  // namespace
}  // namespace palpable

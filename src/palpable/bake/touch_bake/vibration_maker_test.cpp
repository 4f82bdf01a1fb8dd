#include "palpable/bake/touch_bake/vibration_maker.h"

#include "palpable/bake/solid/vibration_modes.h"
#include "palpable/bake/touch_bake/compliance_maker.h"
#include "palpable/bake/touch_bake/touch_maker.h"
#include "palpable/common/base/error.h"
#include "tests/support/standing_rubber.h"
#include "tests/support/test.h"

#include <Eigen/Eigenvalues>

#include <cmath>
#include <numbers>
#include <vector>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::tolerance;

constexpr InertiaSettings kRubber{.density = 1070, .loss_factor = 0.15, .modes = 12, .below = 0};

struct Made {
  SolidModel model;
  SkinResponse skin{model, boundary_of(model.mesh)};

  explicit Made(TetMesh mesh) : model(test::standing_rubber(std::move(mesh))) {}
};

// 30 x 30 x 90 mm.
TetMesh column() { return box_tets({0, 0, 0}, {0.03, 0.03, 0.09}, 4, 4, 12); }

TEST_CASE("the table holds the modes at the nodes of the shell, in the order of its rows",
          "[touch_bake][vibration]") {
  for (const bool quadratic : {false, true}) {
    TetMesh mesh =
        quadratic ? with_edge_nodes(box_tets({0, 0, 0}, {0.03, 0.02, 0.06}, 2, 2, 3)) : column();
    const double volume = tet_volumes(mesh).sum();
    const Made made(std::move(mesh));
    const VibrationTable table = make_vibration(made.skin, kRubber);
    CHECK(trouble_of(table, made.skin.shell_count()).empty());
    CHECK(made.skin.shell_count() > made.skin.vertex_count());
    CHECK(table.loss_factor == 0.15);
    CHECK(table.damping() == 0.075);
    CHECK(table.density == 1070);
    CHECK(table.mass == Approx(1070 * volume).epsilon(1e-12));
    const VibrationModes modes = vibration_modes(made.skin.body(), 1070, {.least = 12, .below = 0});
    REQUIRE(table.mode_count() == modes.omega.size());
    for (Index k = 0; k < modes.omega.size(); ++k) {
      CHECK(table.omega[static_cast<std::size_t>(k)] == modes.omega[k]);
      for (int n = 0; n < made.skin.shell_count(); ++n) {
        const Eigen::Vector3f there =
            modes.shapes.block<3, 1>(3 * Index{made.skin.shell_nodes()[n]}, k).cast<float>();
        for (int c = 0; c < 3; ++c) CHECK(table.shapes(k, 3 * n + c) == there[c]);
      }
    }
  }
}

TEST_CASE("without the modes a compliance is left that still gives way to every force",
          "[touch_bake][vibration]") {
  const Made made(column());
  const VibrationTable vibration = make_vibration(made.skin, kRubber);
  const ComplianceTable table =
      make_compliance(made.skin, {.spacing = 0.012, .near_radius = 0.024});
  REQUIRE_FALSE(table.far_first.empty());
  const std::vector<int> vertices = spread_vertices(made.skin, 0, 60);
  const double smallest = smallest_residual_compliance(table, vibration, vertices);
  CHECK(smallest >= -tolerance(kResidualRounding, "rounding of the tables"));
  CHECK_NOTHROW(expect_residual_compliance(made.skin, table, vibration));

  // The same by the full body, without rounding: eigenvalues are not negative at all.
  const auto n = 3 * static_cast<Index>(vertices.size());
  MatrixXd loads = MatrixXd::Zero(3 * Index{made.skin.vertex_count()}, n);
  for (std::size_t a = 0; a < vertices.size(); ++a) {
    loads.block<3, 3>(3 * Index{vertices[a]}, 3 * static_cast<Index>(a)).setIdentity();
  }
  MatrixXd G =
      loads.transpose() * made.skin.on_skin(made.skin.body().linear(made.skin.at_nodes(loads)));
  const double largest = Eigen::SelfAdjointEigenSolver<MatrixXd>(G).eigenvalues()[n - 1];
  const VibrationModes modes = vibration_modes(made.skin.body(), 1070, {.least = 12, .below = 0});
  const MatrixXd shapes =
      loads.transpose() * made.skin.on_skin(modes.shapes) * modes.omega.cwiseInverse().asDiagonal();
  G -= shapes * shapes.transpose();
  const VectorXd left = Eigen::SelfAdjointEigenSolver<MatrixXd>(G).eigenvalues();
  CHECK(left[0] >= -tolerance(1e-10, "rounding of a product in double precision") * largest);
  // The modes hold nearly all of the answer to a force that is spread over the body.
  const VectorXd sideways = VectorXd::Unit(3, 0).replicate(n / 3, 1);
  const double by_modes = (shapes.transpose() * sideways).squaredNorm();
  CHECK(sideways.dot(G * sideways) < 0.02 * by_modes);

  // Modes that are too soft take more than there is.
  VibrationTable soft = vibration;
  for (double& omega : soft.omega) omega *= 0.99;
  CHECK_THROWS_WITH(expect_residual_compliance(made.skin, table, soft),
                    Catch::Contains("give way by more than the skin's compliance") &&
                        Catch::Contains("modes = 0 in [touch]"));
}

TEST_CASE(
    "tables have vibration modes where a density is stated, the same on any number of threads",
    "[touch_bake][vibration]") {
  const Made made(box_tets({0, 0, 0}, {0.05, 0.04, 0.04}, 5, 4, 4));
  TouchBakeSettings settings;
  settings.regions.most = settings.cross.modes = 0;
  CHECK_FALSE(make_touch_tables(made.skin, settings).vibration.has_value());
  settings.inertia = kRubber;
  std::vector<ProgressReport> reports;
  const TouchTables tables = make_touch_tables(made.skin, settings, [&](const ProgressReport& now) {
    if (now.task == "touch: vibration modes") reports.push_back(now);
  });
  REQUIRE(tables.vibration.has_value());
  CHECK(trouble_of(tables, made.skin.skin()).empty());
  REQUIRE(reports.size() == 2);
  CHECK(reports[1].note.find(" modes, ") != std::string::npos);
  settings.threads = 3;
  const TouchTables again = make_touch_tables(made.skin, settings);
  CHECK(again.vibration->omega == tables.vibration->omega);
  CHECK(again.vibration->shapes == tables.vibration->shapes);
}

}  // namespace
}  // namespace palpable

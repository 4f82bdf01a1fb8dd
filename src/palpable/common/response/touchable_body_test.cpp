#include "palpable/common/response/touchable_body.h"

#include "palpable/common/response/nonlinear_response.h"
#include "palpable/common/response/shell_stress.h"
#include "tests/support/dented_sphere.h"
#include "tests/support/some_touch_tables.h"
#include "tests/support/test.h"

#include <Eigen/Core>

#include <array>
#include <vector>

namespace palpable {
namespace {

using Eigen::Matrix3Xf;
using Eigen::Vector3f;

constexpr float kScale = 10;

TEST_CASE("orders two and three and the stress scale with the body", "[response]") {
  TouchableBody small = test::DentedSphere{}.body();
  const SurfaceMesh& skin = small.body.surface;
  small.touch = test::some_touch_tables(skin, 3);
  const TouchableBody large = scaled(small, static_cast<double>(kScale));
  const auto shapes = [&](const TouchableBody& body, float size) {
    const Compliance compliance(body.touch->compliance);
    const RegionMap map(body.body.surface.vertices.cast<float>(), body.touch->regions,
                        body.touch->region_reach);
    NonlinearResponse response(compliance, body.touch->regions, map, body.touch->cross);
    const int v = body.touch->regions[1].vertex;
    response.choose_patches(std::array{v}, std::array{1.0f}, {});
    REQUIRE(response.patch_count() == 1);
    response.evaluate(std::array{VertexForce{v, size * size * Vector3f(1, 2, -5)}});
    response.find_far_targets();
    Matrix3Xf u = Matrix3Xf::Zero(3, compliance.nodes());
    compliance.add_beyond(response.far_targets(), u);
    response.add_near(u);
    return u;
  };
  const Matrix3Xf u = shapes(small, 1), times_ten = shapes(large, kScale);
  REQUIRE(u.norm() > 0);
  CHECK(times_ten.isApprox(kScale * u, 1e-3f));

  ShellStress stress(small.touch->shell, skin.vertex_count());
  ShellStress stress_of_large(large.touch->shell, skin.vertex_count());
  Matrix3Xf moved = Matrix3Xf::Zero(3, stress.nodes());
  moved.row(2).setLinSpaced(0.0f, 0.004f);
  const Matrix3Xf moved_more = kScale * moved;
  std::vector<float> here(static_cast<std::size_t>(skin.vertex_count())), there = here;
  stress.evaluate(moved, here);
  stress_of_large.evaluate(moved_more, there);
  const auto as_vector = [](const std::vector<float>& numbers) {
    return Eigen::VectorXf(Eigen::Map<const Eigen::VectorXf>(
        numbers.data(), static_cast<Eigen::Index>(numbers.size())));
  };
  REQUIRE(as_vector(here).maxCoeff() > 100.0f);
  CHECK(as_vector(there).isApprox(as_vector(here), 1e-3f));
}

TEST_CASE("a body of half the size rings twice as fast under the same laws", "[response]") {
  TouchableBody body = test::DentedSphere{}.body();
  body.touch = test::some_touch_tables(body.body.surface, 0);
  body.touch->vibration = test::some_vibration(body.touch->shell.nodes());
  const VibrationTable& own = *body.touch->vibration;
  const double s = 0.5;
  const TouchableBody small = scaled(body, s);
  const VibrationTable& changed = small.touch->vibration.value();
  CHECK(trouble_of(changed, body.touch->shell.nodes()).empty());
  CHECK(changed.loss_factor == own.loss_factor);
  CHECK(changed.density == own.density);
  CHECK(changed.mass == Approx(own.mass / 8));
  for (std::size_t k = 0; k < own.omega.size(); ++k) {
    CHECK(changed.omega[k] == Approx(2 * own.omega[k]));
  }
  // A force that is scaled as stress times area moves a mode, after 1 / omega of its own, by as
  // many of its lengths: phi (phi f) / omega^2 is s times as large under s^2 times the force.
  const auto static_part = [](const VibrationTable& table, std::size_t k) {
    const auto row = table.shapes.row(static_cast<Eigen::Index>(k)).cast<double>();
    return Eigen::MatrixXd(row.transpose() * row / (table.omega[k] * table.omega[k]));
  };
  CHECK((s * s * static_part(changed, 2)).isApprox(s * static_part(own, 2), 1e-5));
  // Modal mass: phi^2 rho volume stays 1.
  CHECK(changed.shapes.squaredNorm() * static_cast<float>(changed.mass) ==
        Approx(own.shapes.squaredNorm() * static_cast<float>(own.mass)));
}

}  // namespace
}  // namespace palpable

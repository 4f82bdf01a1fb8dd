#include "palpable/common/reduced/pressed_surface.h"

#include "palpable/common/base/contract.h"
#include "tests/support/allocations.h"
#include "tests/support/bodies.h"
#include "tests/support/test.h"

#include <array>
#include <vector>

namespace palpable {
namespace {

using test::tolerance;

TEST_CASE("a pressed surface has the displacement, normals and stress that are computed one by one",
          "[reduced]") {
  const ReducedBody body = test::pressed_ball();  // 642 vertices: a whole block and a part of one
  const Eigen::Index V = body.surface.vertices.cols();
  const Eigen::Matrix3Xf rest = body.surface.vertices.cast<float>();
  const std::array mu{4.0, 0.7};
  Eigen::Matrix3Xf vertices(3, V), normals(3, V), u(3, V), expected(3, V);
  const auto count = static_cast<std::size_t>(V);
  std::vector<float> stress(6 * count), mises(count), all(count);
  press_surface(body, rest, mu, vertices, normals, mises);

  body.displacement.evaluate(mu, std::span<float>(u.data(), 3 * count));
  CHECK(vertices == rest + u);
  body.stress.evaluate(mu, stress);
  von_mises(stress, all);
  CHECK(mises == all);
  vertex_normals(vertices, body.surface.triangles, expected);
  CHECK((normals - expected).cwiseAbs().maxCoeff() <=
        tolerance(1e-6, "single precision of unit vectors"));
  CHECK((normals.colwise().norm().array() - 1).abs().maxCoeff() <= tolerance(2e-7, "likewise"));

  // When the six components are requested, too, the results are the same, and the components are
  // those of the stress field.
  std::vector<float> six(6 * count), again(count);
  press_surface(body, rest, mu, vertices, normals, again, six);
  CHECK(again == mises);
  CHECK(six == stress);

  CHECK(test::allocations_during(
            [&] { press_surface(body, rest, mu, vertices, normals, mises); }) == 0);
}

TEST_CASE("arrays of another length are refused", "[reduced][errors]") {
  const ReducedBody body = test::pressed_ball(0.05, 0.01, 1);
  const Eigen::Index V = body.surface.vertices.cols();
  const Eigen::Matrix3Xf rest = body.surface.vertices.cast<float>();
  Eigen::Matrix3Xf vertices(3, V), normals(3, V - 1);
  std::vector<float> mises(V);
  CHECK_THROWS_AS(press_surface(body, rest, std::array{0.0, 0.5}, vertices, normals, mises),
                  ContractViolation);
  Eigen::Matrix3Xf all(3, V);
  std::vector<float> five(5 * static_cast<std::size_t>(V));
  CHECK_THROWS_AS(press_surface(body, rest, std::array{0.0, 0.5}, vertices, all, mises, five),
                  ContractViolation);
}

}  // namespace
}  // namespace palpable

#include "palpable/bake/solid/stress.h"

#include "palpable/common/base/error.h"
#include "tests/support/test.h"

#include <Eigen/LU>

namespace palpable {
namespace {

using Catch::Matchers::Contains;
using Eigen::Matrix3d;
using test::tolerance;

SolidModel cube() {
  SolidModel model;
  model.mesh = box_tets({0, 0, 0}, {1, 2, 1}, 2, 3, 2);
  model.material = material_from_young("neo-hookean", 1000, 0.3);
  return model;
}

TEST_CASE("a uniform deformation has the same Cauchy stress at every element and node",
          "[solid][stress]") {
  const SolidModel model = cube();
  Matrix3d F;
  F << 1.2, 0.1, 0.0,  //
      -0.2, 0.9, 0.3,  //
      0.0, 0.1, 1.1;
  const Eigen::Matrix3Xd u = (F - Matrix3d::Identity()) * model.mesh.nodes;
  const Matrix3d sigma = first_piola(model.material, F) * F.transpose() / F.determinant();
  Eigen::Matrix<double, 6, 1> expected;  // the documented order
  expected << sigma(0, 0), sigma(1, 1), sigma(2, 2), sigma(0, 1), sigma(1, 2), sigma(0, 2);
  for (const StressField& stress :
       {element_cauchy_stress(model, u), nodal_cauchy_stress(model, u)}) {
    CHECK((stress.colwise() - expected).cwiseAbs().maxCoeff() <=
          tolerance(1e-10, "rounding of stresses of order 1e3"));
  }
  CHECK(element_cauchy_stress(model, u).cols() == model.mesh.tet_count());
  CHECK(nodal_cauchy_stress(model, u).cols() == model.mesh.node_count());
}

TEST_CASE("a body that is moved and turned as a whole carries no stress", "[solid][stress]") {
  const SolidModel model = cube();
  Matrix3d Q;
  Q << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  Eigen::Matrix3Xd u = (Q - Matrix3d::Identity()) * model.mesh.nodes;
  u.colwise() += Eigen::Vector3d(3, 4, 5);
  CHECK(nodal_cauchy_stress(model, u).cwiseAbs().maxCoeff() <=
        tolerance(1e-10, "rounding of mu = 385 times numbers of order 5"));
}

TEST_CASE("the von Mises stress of tension, shear and pressure is that of the books",
          "[solid][stress]") {
  StressField stress(6, 3);
  stress.col(0) << 7, 0, 0, 0, 0, 0;
  stress.col(1) << 0, 0, 0, 0, 2, 0;
  stress.col(2) << -3, -3, -3, 0, 0, 0;
  const Eigen::VectorXd s = von_mises(stress);
  CHECK(s[0] == Approx(7.0));
  CHECK(s[1] == Approx(2.0 * std::sqrt(3.0)));
  CHECK(s[2] == 0.0);
}

TEST_CASE("principal stresses come largest first and keep trace and von Mises", "[solid][stress]") {
  StressField stress(6, 2);
  stress.col(0) << 0, 0, 0, 0, 2, 0;  // shear: +2, 0, -2
  stress.col(1) << 5, -1, 3, 0.5, 2, -1;
  const Eigen::Matrix3Xd p = principal_stresses(stress);
  CHECK(p(0, 0) == Approx(2.0));
  CHECK(p(1, 0) == Approx(0.0).margin(tolerance(1e-14, "rounding")));
  CHECK(p(2, 0) == Approx(-2.0));
  CHECK((p(0, 1) > p(1, 1) && p(1, 1) > p(2, 1)));
  CHECK(p.col(1).sum() == Approx(7.0));
  StressField diagonal = StressField::Zero(6, 1);
  diagonal.topRows<3>() = p.col(1);
  CHECK(von_mises(diagonal)[0] == Approx(von_mises(stress)[1]));
}

TEST_CASE("an inverted element has no Cauchy stress and is named", "[solid][stress][errors]") {
  const SolidModel model = cube();
  Eigen::Matrix3Xd u = Eigen::Matrix3Xd::Zero(3, model.mesh.node_count());
  u(2, model.mesh.tets(0, 5)) = 100.0;
  CHECK_THROWS_WITH(nodal_cauchy_stress(model, u), Contains("element") && Contains("inverted"));
}

}  // namespace
}  // namespace palpable

// 10-node tetrahedra: the element, and the solver with them.
#include "palpable/bake/solid/block_matrix.h"
#include "palpable/bake/solid/equilibrium.h"
#include "palpable/bake/solid/loads.h"
#include "palpable/bake/solid/selection.h"
#include "palpable/bake/solid/stress.h"
#include "palpable/bake/solid/tet_assembly.h"
#include "palpable/common/base/error.h"
#include "palpable/common/geometry/quadrature.h"
#include "palpable/common/geometry/shape_gradients.h"
#include "tests/support/test.h"

#include <Eigen/Dense>

#include <array>
#include <cmath>

namespace palpable {
namespace {

using Catch::Matchers::Contains;
using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using test::tolerance;

constexpr std::array kFull{1.0};

bool on_unit_cube(const Vector3d& X) {
  return (X.array() == 0.0).any() || (X.array() == 1.0).any();
}

// A unit cube of straight-edged 10-node elements whose inner corners are moved at random by up to a
// quarter of the mesh size.
TetMesh distorted_cube(int cells) {
  TetMesh mesh = box_tets({0, 0, 0}, {1, 1, 1}, cells, cells, cells);
  auto random = test::random_case(5);
  std::uniform_real_distribution<double> shift(-0.25 / cells, 0.25 / cells);
  for (int n = 0; n < mesh.node_count(); ++n) {
    if (on_unit_cube(mesh.nodes.col(n))) continue;
    for (int i = 0; i < 3; ++i) mesh.nodes(i, n) += shift(random);
  }
  return with_edge_nodes(mesh);
}

SolidModel cube(const std::string& law, int cells) {
  SolidModel model;
  model.mesh = distorted_cube(cells);
  model.material = material_from_young(law, 1000, 0.4);
  model.fixed_nodes = nodes_on_plane(model.mesh, {0, 0, 0}, {0, 0, 1}, 1e-12);
  return model;
}

Matrix3Xd some_displacement(const SolidModel& model, unsigned seed) {
  auto random = test::random_case(seed);
  std::uniform_real_distribution<double> shift(-0.01, 0.01);
  Matrix3Xd u(3, model.mesh.node_count());
  for (double& value : u.reshaped()) value = shift(random);
  for (const int n : model.fixed_nodes) u.col(n).setZero();
  return u;
}

TEST_CASE("quadratic shape functions are 1 at their node and 0 at the others, with their slopes",
          "[solid][quadratic]") {
  Eigen::Matrix<double, 4, 10> barycentrics = Eigen::Matrix<double, 4, 10>::Zero();
  barycentrics.leftCols<4>().setIdentity();
  for (int k = 0; k < 6; ++k) {
    barycentrics(kTetEdges[k][0], 4 + k) = barycentrics(kTetEdges[k][1], 4 + k) = 0.5;
  }
  for (int a = 0; a < 10; ++a) {
    const QuadraticShape shape = quadratic_shape(barycentrics.col(a));
    for (int b = 0; b < 10; ++b) CHECK(shape.N[b] == (a == b ? 1.0 : 0.0));
  }
  const Eigen::Vector4d L(0.1, 0.2, 0.3, 0.4);
  const double h = 1e-3;  // central differences are exact for quadratics
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector4d step = h * (Eigen::Vector4d::Unit(k + 1) - Eigen::Vector4d::Unit(0));
    const Eigen::Matrix<double, 10, 1> numeric =
        (quadratic_shape(L + step).N - quadratic_shape(L - step).N) / (2 * h);
    CHECK((numeric - quadratic_shape(L).slope.row(k).transpose()).norm() <=
          tolerance(1e-12, "rounding over h = 1e-3"));
  }
}

TEST_CASE("gradients of a quadratic field are exact at every point of a straight-edged element",
          "[solid][quadratic]") {
  const TetMesh mesh = distorted_cube(2);
  const auto f = [](const Vector3d& X) {
    return X[0] * X[0] - 2 * X[0] * X[1] + X[2] * X[2] + X[1];
  };
  const auto slope = [](const Vector3d& X) {
    return Vector3d(2 * X[0] - 2 * X[1], -2 * X[0] + 1, 2 * X[2]);
  };
  const Eigen::VectorXd volumes = tet_volumes(mesh);
  for (int e = 0; e < mesh.tet_count(); ++e) {
    for (const auto& [L, weight] : four_point_rule()) {
      const QuadraticShape shape = quadratic_shape(L);
      const QuadraticGradients at = quadratic_gradients(mesh, e, shape);
      const Eigen::Matrix<int, 10, 1> nodes = quadratic_nodes(mesh, e);
      const Vector3d X = mesh.nodes(Eigen::all, nodes) * shape.N;
      Vector3d gradient = Vector3d::Zero();
      for (int a = 0; a < 10; ++a) gradient += f(mesh.nodes.col(nodes[a])) * at.g.col(a);
      CHECK((gradient - slope(X)).norm() <= tolerance(1e-11, "rounding, elements of 0.5"));
      CHECK(at.volume == Approx(volumes[e]).epsilon(tolerance(1e-12, "rounding")));
    }
  }
}

TEST_CASE("one element resists every motion but the six rigid ones", "[solid][quadratic]") {
  // The stiffness at rest of a single distorted element, of which no node is held. TetAssembly
  // alone, unlike a solver, needs no supports.
  TetMesh one;
  one.nodes.resize(3, 4);
  one.nodes << 0, 1, 0.2, 0.1,  //
      0, 0.1, 0.9, 0.2,         //
      0, 0, 0.1, 1.1;
  one.tets.resize(4, 1);
  one.tets << 0, 1, 2, 3;
  SolidModel model;
  model.mesh = with_edge_nodes(one);
  for (const std::string& law : law_names()) {
    INFO(law);
    model.material = material_from_young(law, 1.0, 0.3);
    const TetAssembly assembly(model);
    BlockMatrix K(assembly.pattern());
    PassFields fields;
    assembly.set_state(Matrix3Xd::Zero(3, 10), fields);
    assembly.tangent(fields, K);
    Eigen::MatrixXd dense(30, 30);
    for (int r = 0; r < 30; ++r) {
      Eigen::VectorXd column;
      K.multiply(Eigen::VectorXd::Unit(30, r), column);
      dense.col(r) = column;
    }
    CHECK((dense - dense.transpose()).norm() <= tolerance(1e-14, "rounding") * dense.norm());
    const Eigen::VectorXd eigen =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dense).eigenvalues();
    CHECK(eigen.head<6>().cwiseAbs().maxCoeff() <= tolerance(1e-14, "rounding") * eigen[29]);
    CHECK(eigen[6] > 1e-3 * eigen[29]);
  }
}

TEST_CASE("with 10-node elements, forces and tangent are derivatives of the stored energy",
          "[solid][quadratic]") {
  for (const std::string& law : law_names()) {
    INFO(law);
    const SolidModel model = cube(law, 2);
    const EquilibriumSolver solver(model);
    const Matrix3Xd u = some_displacement(model, 1);
    for (unsigned seed = 2; seed < 6; ++seed) {
      const Matrix3Xd du = some_displacement(model, seed);
      const double h = 1e-3;
      const double work =
          (solver.stored_energy(u + h * du) - solver.stored_energy(u - h * du)) / (2 * h);
      const Matrix3Xd force = solver.internal_force(u);
      CHECK(std::abs(work - force.cwiseProduct(du).sum()) <=
            tolerance(1e-7, "central differences, h = 1e-3 of du") * force.norm() * du.norm());
      Matrix3Xd numeric =
          (solver.internal_force(u + h * du) - solver.internal_force(u - h * du)) / (2 * h);
      for (const int n : model.fixed_nodes) numeric.col(n).setZero();
      const Matrix3Xd exact = solver.tangent_times(u, du);
      CHECK((numeric - exact).norm() <=
            tolerance(1e-6, "central differences, h = 1e-3 of du") * exact.norm());
    }
  }
}

TEST_CASE("a linear displacement of the surface is reproduced exactly by 10-node elements",
          "[solid][quadratic][patch-test]") {
  Matrix3d F;
  F << 1.25, 0.2, 0.0, -0.1, 0.85, 0.15, 0.05, 0.0, 1.1;
  for (const std::string& law : law_names()) {
    INFO(law);
    SolidModel model = cube(law, 2);
    model.fixed_nodes.clear();
    for (int n = 0; n < model.mesh.node_count(); ++n) {
      if (on_unit_cube(model.mesh.nodes.col(n))) model.fixed_nodes.push_back(n);
    }
    const Matrix3Xd exact = (F - Matrix3d::Identity()) * model.mesh.nodes;
    model.fixed_displacement = exact(Eigen::all, model.fixed_nodes);
    const Matrix3Xd none = Matrix3Xd::Zero(3, model.mesh.node_count());
    const PathResult path = EquilibriumSolver(model, {.tolerance = 1e-12}).solve_path(none, kFull);
    INFO(path.why_stopped);
    REQUIRE(path.complete);
    const Matrix3Xd& u = path.steps.back().displacement;
    CHECK((u - exact).cwiseAbs().maxCoeff() <=
          tolerance(1e-11, "residual of 1e-12 over a condition of tens"));
    const Matrix3d sigma = first_piola(model.material, F) * F.transpose() / F.determinant();
    for (const StressField& stress :
         {point_cauchy_stress(model, u), element_cauchy_stress(model, u),
          nodal_cauchy_stress(model, u)}) {
      CHECK((stress.row(3).array() - sigma(0, 1)).abs().maxCoeff() <=
            tolerance(1e-9, "as above, times 1e3 Pa over elements of 0.25"));
    }
  }
}

TEST_CASE("pure bending, a quadratic displacement, is exact with 10-node elements",
          "[solid][quadratic][patch-test]") {
  // Small strains: sigma_xx = E kappa z and nothing else solves linear elasticity, with
  // u = kappa (x z, -nu y z, (-x^2 + nu (y^2 - z^2)) / 2), which the elements can represent. The
  // nonlinear solver differs by the square of the strain.
  const double E = 1000, nu = 0.3, kappa = 1e-5;
  SolidModel model;
  model.mesh = distorted_cube(2);
  model.material = material_from_young("saint-venant-kirchhoff", E, nu);
  const auto exact = [&](const Vector3d& X) {
    const double x = X[0], y = X[1] - 0.5, z = X[2] - 0.5;
    return Vector3d(kappa * x * z, -nu * kappa * y * z,
                    0.5 * kappa * (-x * x + nu * (y * y - z * z)));
  };
  model.fixed_nodes = nodes_on_plane(model.mesh, {0, 0, 0}, {1, 0, 0}, 1e-12);
  model.fixed_displacement.resize(3, static_cast<Eigen::Index>(model.fixed_nodes.size()));
  for (std::size_t k = 0; k < model.fixed_nodes.size(); ++k) {
    model.fixed_displacement.col(static_cast<Eigen::Index>(k)) =
        exact(model.mesh.nodes.col(model.fixed_nodes[k]));
  }
  const Eigen::Matrix3Xi end = triangles_between(
      skin_triangles(model.mesh), nodes_on_plane(model.mesh, {1, 0, 0}, {1, 0, 0}, 1e-12));
  const Matrix3Xd load =
      traction_load(model.mesh, end, [&](const Vector3d& X, const Vector3d& n) -> Vector3d {
        return E * kappa * (X[2] - 0.5) * n;
      });
  const PathResult path = EquilibriumSolver(model, {.tolerance = 1e-9}).solve_path(load, kFull);
  INFO(path.why_stopped);
  REQUIRE(path.complete);
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    CHECK((path.steps.back().displacement.col(n) - exact(model.mesh.nodes.col(n))).norm() <=
          tolerance(1e-4, "strains of 1e-5, squared, over those, and the constants") * kappa);
  }
}

TEST_CASE("turning a body of 10-node elements as a whole takes no force", "[solid][quadratic]") {
  const SolidModel model = cube("neo-hookean", 2);
  const Matrix3d Q = Eigen::AngleAxisd(2.0, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  const Matrix3Xd u = (Q - Matrix3d::Identity()) * model.mesh.nodes;
  const EquilibriumSolver solver(model);
  CHECK(solver.internal_force(u).cwiseAbs().maxCoeff() <= tolerance(1e-10, "rounding of 1e3 Pa"));
  CHECK(solver.stored_energy(u) <= tolerance(1e-10, "rounding of 1e3 Pa"));
  // A bent state, turned: the forces turn with it.
  const Matrix3Xd bent = some_displacement(model, 3);
  const Matrix3Xd turned = Q * (model.mesh.nodes + bent) - model.mesh.nodes;
  CHECK((solver.internal_force(turned) - Q * solver.internal_force(bent)).cwiseAbs().maxCoeff() <=
        tolerance(1e-10, "rounding of 1e3 Pa"));
}

TEST_CASE("a path with 10-node elements is in equilibrium, and softer than with 4-node ones",
          "[solid][quadratic][path]") {
  SolidModel model = cube("neo-hookean", 2);
  const auto press = [](const TetMesh& mesh) {
    const Eigen::Matrix3Xi top =
        triangles_between(skin_triangles(mesh), nodes_on_plane(mesh, {0, 0, 1}, {0, 0, 1}, 1e-12));
    return traction_load(mesh, top, [](const Vector3d& X, const Vector3d&) {
      return Vector3d(150.0 * X[0], 0, -100.0);
    });
  };
  const Matrix3Xd load = press(model.mesh);
  const EquilibriumSolver solver(model);
  const PathResult path = solver.solve_path(load, std::array{0.5, 1.0});
  INFO(path.why_stopped);
  REQUIRE(path.complete);
  const Matrix3Xd& u = path.steps.back().displacement;
  Matrix3Xd left_over = load - solver.internal_force(u);
  for (const int n : model.fixed_nodes) left_over.col(n).setZero();
  CHECK(left_over.norm() <= 1e-8 * solver.internal_force(u).norm());

  // Linear elements on the same corners are a subspace: by the minimum of the potential they do
  // less work.
  SolidModel linear = model;
  const int N = 27;
  linear.mesh.nodes = model.mesh.nodes.leftCols(N).eval();
  linear.mesh.edge_nodes.resize(6, 0);
  linear.fixed_nodes = nodes_on_plane(linear.mesh, {0, 0, 0}, {0, 0, 1}, 1e-12);
  const Matrix3Xd linear_load = press(linear.mesh);
  const PathResult stiff = EquilibriumSolver(linear).solve_path(linear_load, kFull);
  REQUIRE(stiff.complete);
  const double work = load.cwiseProduct(u).sum();
  const double linear_work = linear_load.cwiseProduct(stiff.steps.back().displacement).sum();
  CHECK(linear_work < 0.95 * work);
  CHECK(linear_work > 0.3 * work);
}

TEST_CASE("edge nodes that turn an element inside out are refused", "[solid][quadratic][errors]") {
  SolidModel model = cube("neo-hookean", 1);
  model.mesh.nodes.col(model.mesh.edge_nodes(0, 2)) += Vector3d(3, 3, 3);
  CHECK_THROWS_WITH(check_model(model), Contains("edge nodes") && Contains("inside out"));
  model = cube("neo-hookean", 1);
  model.mesh.edge_nodes(3, 4) = 99;
  CHECK_THROWS_WITH(check_model(model), Contains("tetrahedron 4") && Contains("edge node"));
  model = cube("neo-hookean", 1);
  model.mesh.edge_nodes.conservativeResize(6, 3);
  CHECK_THROWS_WITH(check_model(model), Contains("edge nodes for 3"));
}

TEST_CASE("elements of another material are felt where they are", "[solid][groups]") {
  // Two layers in series under a uniaxial strain: the same force per area through both.
  for (const bool quadratic : {false, true}) {
    SolidModel model;
    model.mesh = box_tets({0, 0, 0}, {1, 1, 1}, 2, 2, 2);
    if (quadratic) model.mesh = with_edge_nodes(model.mesh);
    model.material = material_from_young("neo-hookean", 1000, 0.3);
    MaterialGroup hard{material_from_young("saint-venant-kirchhoff", 5000, 0.2), {}};
    for (int e = 0; e < model.mesh.tet_count(); ++e) {
      if (model.mesh.nodes(Eigen::all, model.mesh.tets.col(e)).row(2).mean() > 0.5) {
        hard.elements.push_back(e);
      }
    }
    model.groups = {hard};
    for (int n = 0; n < model.mesh.node_count(); ++n) {
      const double z = model.mesh.nodes(2, n);
      model.supports.push_back({.node = n, .held = {true, true, z == 0.0 || z == 1.0}});
      if (z == 1.0) model.supports.back().displacement[2] = 0.3;
    }
    const Matrix3Xd none = Matrix3Xd::Zero(3, model.mesh.node_count());
    const PathResult path =
        EquilibriumSolver(model, {.tolerance = 1e-11}).solve_path(none, std::array{0.5, 1.0});
    INFO(path.why_stopped);
    REQUIRE(path.complete);
    const Matrix3Xd& u = path.steps.back().displacement;
    const int middle = nearest_node(model.mesh, {0.5, 0.5, 0.5});
    const auto pull = [](const Material& material, double stretch) {
      return first_piola(material, Vector3d(1, 1, stretch).asDiagonal())(2, 2);
    };
    const double soft = pull(model.material, 1 + 2 * u(2, middle));
    CHECK(soft == Approx(pull(hard.material, 1 + 2 * (0.3 - u(2, middle))))
                      .epsilon(tolerance(1e-9, "residual of 1e-11 over a condition of tens")));
    const StressField stress = element_cauchy_stress(model, u);
    CHECK((stress.row(2).array() - soft).abs().maxCoeff() <= tolerance(1e-8, "as above") * soft);
  }
}

TEST_CASE("groups of elements that overlap or miss the body are refused",
          "[solid][groups][errors]") {
  SolidModel model = cube("neo-hookean", 1);
  const Material other = material_from_young("neo-hookean", 2000, 0.3);
  model.groups = {{other, {0, 1}}, {other, {1}}};
  CHECK_THROWS_WITH(check_model(model), Contains("tetrahedron 1") && Contains("twice"));
  model.groups = {{other, {6}}};
  CHECK_THROWS_WITH(check_model(model), Contains("tetrahedron 6") && Contains("0 to 5"));
  model.groups = {{NeoHookean{.C1 = 0, .D1 = 1}, {1}}};
  CHECK_THROWS_WITH(check_model(model), Contains("C1 = 0"));
}

}  // namespace
}  // namespace palpable

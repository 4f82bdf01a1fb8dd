// The passes over eight elements at a time, against the laws at one point at a time.
#include "palpable/bake/solid/element_kernels.h"

#include "palpable/bake/solid/equilibrium.h"
#include "palpable/bake/solid/tet_assembly.h"
#include "palpable/common/geometry/tet_mesh.h"
#include "tests/support/test.h"

#include <Eigen/Dense>

#include <limits>

namespace palpable {
namespace {

using Eigen::Matrix3Xd;
using test::tolerance;

// The levels that this processor has.
std::vector<SimdLevel> levels() {
  std::vector<SimdLevel> list{SimdLevel::kPlain};
  if (best_simd_level() != SimdLevel::kPlain) list.push_back(SimdLevel::kAvx2);
  if (best_simd_level() == SimdLevel::kAvx512) list.push_back(SimdLevel::kAvx512);
  return list;
}

TEST_CASE("logarithm and inverse cube root of a pack are those of its numbers", "[solid][simd]") {
  for (double x = 1e-3; x < 1e3; x *= 1.0137) {
    Pack pack{};
    for (int lane = 0; lane < kPackSize; ++lane) pack[lane] = x * (1.0 + 1e-3 * lane);
    const Pack logarithms = logarithm(pack), roots = inverse_cube_root(pack);
    for (int lane = 0; lane < kPackSize; ++lane) {
      INFO("x = " << pack[lane]);
      CHECK(logarithms[lane] == Approx(std::log(pack[lane])).epsilon(1e-15).margin(2e-16));
      CHECK(roots[lane] ==
            Approx(1.0 / std::cbrt(pack[lane])).epsilon(tolerance(2e-15, "eight roundings")));
    }
  }
  // Near 1, where bodies are, the logarithm keeps its relative accuracy.
  for (const double strain : {-1e-3, -1e-9, 1e-12, 1e-6}) {
    const Pack pack = Pack{} + (1.0 + strain);
    CHECK(logarithm(pack)[0] == Approx(std::log(1.0 + strain)).epsilon(1e-15).margin(0));
  }
}

// 30 elements: the last block is not full.
SolidModel small_body(const std::string& law, bool quadratic) {
  SolidModel model;
  model.mesh = box_tets({0, 0, 0}, {0.2, 0.1, 0.1}, 5, 1, 1);
  if (quadratic) model.mesh = with_edge_nodes(model.mesh);
  model.material = material_from_young(law, 2.5, 0.35);
  MaterialGroup stiff{.material = material_from_young("neo-hookean", 10.0, 0.2), .elements = {}};
  for (int e = 0; e < model.mesh.tet_count(); e += 4) stiff.elements.push_back(e);
  model.groups.push_back(stiff);
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    if (model.mesh.nodes(0, n) == 0.0) model.fixed_nodes.push_back(n);
  }
  return model;
}

Matrix3Xd field(const SolidModel& model, double size, unsigned seed) {
  auto random = test::random_case(seed);
  std::uniform_real_distribution<double> entry(-size, size);
  return Matrix3Xd::NullaryExpr(3, model.mesh.node_count(), [&] { return entry(random); });
}

TEST_CASE("forces are the derivative of the energy, and their change is the tangent's product",
          "[solid][simd]") {
  for (const bool quadratic : {false, true}) {
    for (const std::string& law : law_names()) {
      const SolidModel model = small_body(law, quadratic);
      const Matrix3Xd u = field(model, 4e-3, 1), du = field(model, 1.0, 2);
      for (const SimdLevel level : levels()) {
        INFO(law << (quadratic ? ", 10 nodes" : ", 4 nodes") << ", level "
                 << static_cast<int>(level));
        const TetAssembly assembly(model, level);
        Matrix3Xd force(3, u.cols()), other(3, u.cols()), change(3, u.cols());
        PassFields fields;
        const auto energy_at = [&](const Matrix3Xd& where, Matrix3Xd& found) {
          assembly.set_state(where, fields);
          return assembly.force(fields, found).energy;
        };
        const double energy = energy_at(u, force);
        REQUIRE(std::isfinite(energy));
        const double h = 1e-7;
        const double up = energy_at(u + h * du, other);
        const Matrix3Xd force_up = other;
        const double down = energy_at(u - h * du, other);
        CHECK((up - down) / (2 * h) == Approx(force.cwiseProduct(du).sum()).epsilon(1e-6));
        assembly.set_state(u, fields);
        assembly.force_change(fields, du, change);
        CHECK((change - (force_up - other) / (2 * h)).norm() <=
              tolerance(1e-6, "rounding and third derivatives at h = 1e-7") * change.norm());
        BlockMatrix K(assembly.pattern());
        assembly.tangent(fields, K);
        Eigen::VectorXd x, y, expected;
        assembly.gather(du, x);
        assembly.tangent_product(fields, x, expected);  // after a direction in which all nodes move
        K.multiply(x, y);
        CHECK((y - expected).norm() <= tolerance(1e-13, "the same sums") * expected.norm());
      }
    }
  }
}

TEST_CASE("every level of instructions gives the same numbers", "[solid][simd]") {
  const SolidModel model = small_body("mooney-rivlin", true);
  const Matrix3Xd u = field(model, 4e-3, 5);
  Matrix3Xd plain(3, u.cols()), wide(3, u.cols());
  PassFields fields;
  const auto force = [&](SimdLevel level, Matrix3Xd& found) {
    const TetAssembly assembly(model, level);
    assembly.set_state(u, fields);
    return assembly.force(fields, found);
  };
  const BodyState expected = force(SimdLevel::kPlain, plain);
  for (const SimdLevel level : levels()) {
    const BodyState state = force(level, wide);
    CHECK((wide - plain).norm() <= tolerance(1e-14, "sums of a few roundings") * plain.norm());
    CHECK(state.energy == Approx(expected.energy).epsilon(1e-13));
    CHECK(state.most_compressed == expected.most_compressed);
    CHECK(state.smallest_volume_ratio == Approx(expected.smallest_volume_ratio).epsilon(1e-13));
  }
}

TEST_CASE("an inverted element is found wherever it lies in its block", "[solid][simd]") {
  const SolidModel model = small_body("neo-hooke-abaqus", false);
  for (const SimdLevel level : levels()) {
    const TetAssembly assembly(model, level);
    Matrix3Xd force(3, model.mesh.node_count());
    for (int e = 0; e < model.mesh.tet_count(); ++e) {
      // Moves the first corner through the opposite face, as far beyond it as it was before it.
      Matrix3Xd u = Matrix3Xd::Zero(3, model.mesh.node_count());
      const Eigen::Vector4i n = model.mesh.tets.col(e);
      const Eigen::Vector3d across =
          (model.mesh.nodes.col(n[1]) + model.mesh.nodes.col(n[2]) + model.mesh.nodes.col(n[3])) /
              3.0 -
          model.mesh.nodes.col(n[0]);
      u.col(n[0]) = 2.0 * across;
      PassFields fields;
      assembly.set_state(u, fields);
      const BodyState state = assembly.force(fields, force);
      INFO("element " << e);
      CHECK(std::isinf(state.energy));
      CHECK(state.smallest_volume_ratio < 0.0);
      TetMesh turned = model.mesh;
      turned.nodes += u;
      const Eigen::ArrayXd ratios = tet_volumes(turned).array() / tet_volumes(model.mesh).array();
      CHECK(state.smallest_volume_ratio == Approx(ratios.minCoeff()).epsilon(1e-12));
      CHECK(ratios[state.most_compressed] == Approx(ratios.minCoeff()).epsilon(1e-12));
      u.col(n[0]).setConstant(std::numeric_limits<double>::quiet_NaN());
      assembly.set_state(u, fields);
      CHECK(std::isinf(assembly.force(fields, force).energy));
    }
  }
}

}  // namespace
}  // namespace palpable

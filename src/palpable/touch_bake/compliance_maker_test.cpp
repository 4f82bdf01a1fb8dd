#include "palpable/touch_bake/compliance_maker.h"

#include "palpable/solid/modal_forms.h"
#include "palpable/touch/nonlinear_answer.h"
#include "palpable/touch_bake/region_maker.h"
#include "tests/support/test.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xf;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::Vector3f;
using Eigen::VectorXd;
using test::tolerance;

// 60 x 45 x 20 mm of rubber, held below.
SolidModel block() {
  SolidModel model;
  model.mesh = box_tets({0, 0, 0}, {0.06, 0.045, 0.02}, 9, 7, 4);
  model.material = material_from_young("neo-hookean", 60e3, 0.4);
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    if (model.mesh.nodes(2, n) < 1e-6) model.fixed_nodes.push_back(n);
  }
  return model;
}

struct Made {
  SolidModel model = block();
  SkinResponse skin{model, boundary_of(model.mesh)};
  ComplianceTable table = make_compliance(skin, {.spacing = 0.012, .near_radius = 0.024});
  Compliance compliance{table};

  [[nodiscard]] int nearest_vertex(const Vector3d& place) const {
    Index nearest = 0;
    (skin.skin().vertices.colwise() - place).colwise().squaredNorm().minCoeff(&nearest);
    return static_cast<int>(nearest);
  }
};

// G f at the first n nodes, by the table.
Matrix3Xf answer(const Compliance& compliance, int vertex, const Vector3f& force, int n) {
  const std::size_t k = compliance.rank();
  const auto C = static_cast<std::size_t>(compliance.clusters());
  std::vector<float> source(k, 0.0f), targets(k * C, 0.0f);
  compliance.add_source(vertex, force, source);
  const int from = compliance.cluster_of(vertex);
  for (std::size_t to = 0; to < C; ++to) {
    if (!compliance.are_far(from, static_cast<int>(to))) continue;
    compliance.add_target(from, source, static_cast<int>(to), {targets.data() + to * k, k});
  }
  Matrix3Xf u(3, n);
  compliance.everywhere(targets, u);
  compliance.add_near(vertex, force, u);
  return u;
}

TEST_CASE("the table answers at the inner nodes as the full body does, near and far", "[touch]") {
  const Made made;
  const int V = made.skin.vertex_count(), W = made.skin.shell_count();
  REQUIRE(W > V + 20);
  REQUIRE(made.compliance.nodes() == W);
  REQUIRE_FALSE(made.table.far_first.empty());
  const Vector3f force(0.1f, -0.2f, -0.5f);
  for (const Vector3d& place : {Vector3d(0.01, 0.01, 0.02), Vector3d(0.05, 0.03, 0.02)}) {
    const int vertex = made.nearest_vertex(place);
    VectorXd load = VectorXd::Zero(3 * Index{V});
    load.segment<3>(3 * Index{vertex}) = force.cast<double>();
    const MatrixXd exact =
        made.skin.in_shell(made.skin.body().linear(made.skin.at_nodes(load))).reshaped(3, W);
    const Matrix3Xf found = answer(made.compliance, vertex, force, W);
    double near = 0, far = 0, near_size = 0, far_size = 0;  // sums of squares, of inner nodes
    for (int n = V; n < W; ++n) {
      const double error = (found.col(n).cast<double>() - exact.col(n)).squaredNorm();
      const bool is_far = made.compliance.are_far(made.compliance.cluster_of(vertex),
                                                  made.compliance.cluster_of(n));
      (is_far ? far : near) += error;
      (is_far ? far_size : near_size) += exact.col(n).squaredNorm();
    }
    REQUIRE((near_size > 0 && far_size > 0));
    CHECK(std::sqrt(near / near_size) < tolerance(2e-4, "16 bits"));
    CHECK(std::sqrt(far / far_size) < tolerance(0.02, "32 columns of a cluster"));
    // What is asked for the skin alone is the same to the last bit.
    CHECK(answer(made.compliance, vertex, force, V) == found.leftCols(V));
  }
}

TEST_CASE("an inner node belongs to the cluster of the nearest vertex", "[touch]") {
  const Made made;
  const int V = made.skin.vertex_count();
  for (int n = V; n < made.skin.shell_count(); ++n) {
    const int v = made.nearest_vertex(made.model.mesh.nodes.col(made.skin.shell_nodes()[n]));
    CHECK(made.compliance.cluster_of(n) == made.compliance.cluster_of(v));
  }
}

TEST_CASE("a region answers at the inner nodes as at the skin: second and third order", "[touch]") {
  const Made made;
  const int V = made.skin.vertex_count(), W = made.skin.shell_count();
  const ModalFormMaker forms(made.model, made.skin.body().rest());
  const int middle = made.nearest_vertex({0.03, 0.02, 0.02});
  const std::vector<RegionTable> regions{
      make_region(made.skin, forms, made.compliance, middle, {.modes = 64, .loads = 80})};
  CHECK(regions[0].vertices.back() >= V);
  const RegionMap map(made.skin.skin().vertices.cast<float>(), regions, 0.018);
  const CrossTable none;
  NonlinearAnswer answer(made.compliance, regions, map, none);

  // A ball's pressure, 3 mm deep.
  std::vector<VertexForce> loads;
  std::vector<int> vertices;
  VectorXd load = VectorXd::Zero(3 * Index{V});
  for (int v = 0; v < V; ++v) {
    const double r = made.skin.distance(v, middle) / 0.008;
    if (r >= 1) continue;
    const Vector3d force = -0.5 * std::sqrt(1 - r * r) * made.skin.normals().col(v);
    load.segment<3>(3 * Index{v}) = force;
    loads.push_back({v, force.cast<float>()});
    vertices.push_back(v);
  }
  const std::vector<float> weights(vertices.size(), 1.0f);
  answer.choose_blobs(vertices, weights, {});
  REQUIRE(answer.blob_count() == 1);
  answer.evaluate(loads);
  Matrix3Xf u(3, W);
  made.compliance.everywhere(answer.far_targets(), u);
  answer.add_near(u);

  const LoadResponse& body = made.skin.body();
  const VectorXd u_1 = body.linear(made.skin.at_nodes(load));
  const auto free = [&](const VectorXd& force) -> VectorXd {
    return -force.cwiseProduct(body.free_mask());
  };
  const VectorXd u_2 = body.linear(free(body.second_force(u_1)));
  const VectorXd u_3 = body.linear(free(body.third_force(u_1, u_2)));
  const MatrixXd exact = made.skin.in_shell(u_2 + u_3).reshaped(3, W);
  const MatrixXd error = u.cast<double>() - exact;
  const double on_skin = error.leftCols(V).norm() / exact.leftCols(V).norm();
  const double inside = error.rightCols(W - V).norm() / exact.rightCols(W - V).norm();
  INFO(on_skin << " on the skin, " << inside << " inside; largest " << exact.cwiseAbs().maxCoeff());
  CHECK(on_skin < tolerance(0.1, "64 modes, 24 of them to the third order"));
  CHECK(inside < tolerance(0.1, "likewise"));
  // The skin alone is the same to the last bit.
  Matrix3Xf skin(3, V);
  made.compliance.everywhere(answer.far_targets(), skin);
  answer.add_near(skin);
  CHECK(skin == u.leftCols(V));
}

}  // namespace
}  // namespace palpable

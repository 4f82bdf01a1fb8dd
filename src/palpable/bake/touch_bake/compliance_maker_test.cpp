#include "palpable/bake/touch_bake/compliance_maker.h"

#include "palpable/bake/solid/modal_forms.h"
#include "palpable/bake/touch_bake/region_maker.h"
#include "palpable/bake/touch_bake/touch_maker.h"
#include "palpable/common/response/nonlinear_response.h"
#include "palpable/common/response/touch_tables.h"
#include "tests/support/standing_rubber.h"
#include "tests/support/test.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
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

struct Made {
  SolidModel model;
  SkinResponse skin{model, boundary_of(model.mesh)};
  ComplianceTable table = make_compliance(skin, {.spacing = 0.012, .near_radius = 0.024});
  Compliance compliance{table};

  explicit Made(TetMesh mesh) : model(test::standing_rubber(std::move(mesh))) {}

  [[nodiscard]] int nearest_vertex(const Vector3d& place) const {
    Index nearest = 0;
    (skin.skin().vertices.colwise() - place).colwise().squaredNorm().minCoeff(&nearest);
    return static_cast<int>(nearest);
  }
};

// 30 x 30 x 90 mm.
TetMesh column() { return box_tets({0, 0, 0}, {0.03, 0.03, 0.09}, 4, 4, 12); }

// G f at the first n nodes, by the table.
Matrix3Xf response(const Compliance& compliance, int vertex, const Vector3f& force, int n) {
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

TEST_CASE("the table gives the displacement of inner nodes as the full body does, near and far",
          "[touch_bake]") {
  const Made made(column());
  const int V = made.skin.vertex_count(), W = made.skin.shell_count();
  REQUIRE(W > V + 20);
  REQUIRE(made.compliance.nodes() == W);
  REQUIRE_FALSE(made.table.far_first.empty());
  const Vector3f force(0.1f, -0.2f, -0.5f);
  for (const Vector3d& place : {Vector3d(0.03, 0.015, 0.07), Vector3d(0.015, 0, 0.04)}) {
    const int vertex = made.nearest_vertex(place);
    VectorXd load = VectorXd::Zero(3 * Index{V});
    load.segment<3>(3 * Index{vertex}) = force.cast<double>();
    const MatrixXd exact =
        made.skin.in_shell(made.skin.body().linear(made.skin.at_nodes(load))).reshaped(3, W);
    const Matrix3Xf found = response(made.compliance, vertex, force, W);
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
    // Evaluating the skin alone gives the same bits.
    CHECK(response(made.compliance, vertex, force, V) == found.leftCols(V));
  }
}

TEST_CASE("an inner node belongs to the cluster of the nearest vertex that is not held",
          "[touch_bake]") {
  // A block on a held floor: inner nodes just above the floor are nearer to its held vertices than
  // to the walls.
  const Made made(box_tets({0, 0, 0}, {0.06, 0.05, 0.04}, 6, 5, 4));
  const int V = made.skin.vertex_count();
  for (int n = V; n < made.skin.shell_count(); ++n) {
    const Vector3d place = made.model.mesh.nodes.col(made.skin.shell_nodes()[n]);
    double nearest = 1, of_its_cluster = 1;
    for (int v = 0; v < V; ++v) {
      if (made.skin.fixed()[v] != 0) continue;
      const double distance = (made.skin.skin().vertices.col(v) - place).norm();
      nearest = std::min(nearest, distance);
      if (made.compliance.cluster_of(v) != made.compliance.cluster_of(n)) continue;
      of_its_cluster = std::min(of_its_cluster, distance);
    }
    CHECK(of_its_cluster == nearest);
  }
}

// (3N x modes) fields on the whole mesh, from rows for the nodes of the shell; 0 at other nodes.
MatrixXd fields_of(const SkinResponse& skin, const RoundedRows& rows) {
  const MatrixXd in_shell = as_numbers(rows);
  MatrixXd fields = MatrixXd::Zero(skin.body().free_mask().size(), in_shell.cols());
  for (int n = 0; n < skin.shell_count(); ++n) {
    fields.middleRows(3 * Index{skin.shell_nodes()[n]}, 3) = in_shell.middleRows(3 * Index{n}, 3);
  }
  return fields;
}

TEST_CASE("modes keep their rows of the inner nodes: they are orthonormal in the whole body",
          "[touch_bake]") {
  // The shell of the column is all of it, and all clusters are near each other.
  Made made(column());
  made.table = make_compliance(made.skin, {.near_radius = 1.0, .rank = 16});
  const Compliance compliance(made.table);
  const LoadResponse& body = made.skin.body();
  const int N = made.model.mesh.node_count(), W = made.skin.shell_count();
  REQUIRE(W == N);
  const ModalFormMaker forms(made.model, body.rest());
  const RegionTable region =
      make_region(made.skin, forms, compliance, made.nearest_vertex({0.03, 0.015, 0.06}),
                  {.modes = 16, .leading = 4, .loads = 40});
  REQUIRE(static_cast<int>(region.vertices.size()) == W);
  const CrossTable cross =
      make_cross_table(made.skin, forms, {.modes = 16, .places = 20, .pairs = 30});
  for (const RoundedRows* rows : {&region.modes, &cross.modes}) {
    const MatrixXd U = fields_of(made.skin, *rows);
    MatrixXd gram(U.cols(), U.cols());
    for (Index k = 0; k < U.cols(); ++k) {
      gram.col(k) = U.transpose() * body.stiffness_times(U.col(k));
    }
    CHECK((gram - MatrixXd::Identity(gram.rows(), gram.cols())).cwiseAbs().maxCoeff() <
          tolerance(0.004, "16 bits of each row, times the stiffness of short edges"));
  }
  // Evaluating the skin alone gives the same bits.
  const std::vector<RegionTable> regions{region};
  const RegionMap map(made.skin.skin().vertices.cast<float>(), regions, 0.018);
  NonlinearResponse response(compliance, regions, map, cross);
  const std::vector<int> vertices{region.vertex};
  const std::vector<float> weights{1.0f};
  response.choose_patches(vertices, weights, {});
  const std::vector<VertexForce> loads{{region.vertex, {-0.3f, 0.1f, 0.0f}}};
  response.evaluate(loads);
  const int V = made.skin.vertex_count();
  Matrix3Xf all = Matrix3Xf::Zero(3, W), skin = Matrix3Xf::Zero(3, V);
  response.add_near(all);
  response.add_cross(all);
  response.add_near(skin);
  response.add_cross(skin);
  CHECK(skin == all.leftCols(V));
  const Eigen::Map<const Eigen::VectorXf> q(response.q(0).data(), region.mode_count());
  const VectorXd exact = as_numbers(region.modes) * q.cast<double>();
  CHECK((all.reshaped().cast<double>() - exact).cwiseAbs().maxCoeff() <
        tolerance(1e-5, "single precision") * exact.tail(3 * Index{W - V}).cwiseAbs().maxCoeff());
}

TEST_CASE("a table without numbers has the clusters, neighbours and size of the finished one",
          "[touch_bake]") {
  const Made made(column());
  const ComplianceTable empty =
      compliance_without_numbers(made.skin, {.spacing = 0.012, .near_radius = 0.024});
  CHECK(empty.clusters == made.table.clusters);
  CHECK(empty.cluster_of == made.table.cluster_of);
  CHECK(empty.neighbours == made.table.neighbours);
  CHECK(empty.far_first == made.table.far_first);
  const auto size = [](const ComplianceTable& table) {
    TouchTables tables;
    tables.compliance = table;
    return bytes_of(tables);
  };
  CHECK(size(empty) == size(made.table));
  CHECK(trouble_of(empty).empty());
  const RegionSettings settings{.loads = 30};
  const ModalFormMaker forms(made.model, made.skin.body().rest());
  const RegionTable region = make_region(made.skin, forms, made.compliance, 7, settings);
  CHECK(region_nodes(made.skin, Compliance(empty), 7, settings) == region.vertices);
}

}  // namespace
}  // namespace palpable

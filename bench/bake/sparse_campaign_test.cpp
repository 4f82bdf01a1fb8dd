#include "bench/bake/sparse_campaign.h"

#include "palpable/base/error.h"
#include "palpable/campaign/store_rows.h"
#include "palpable/describe/body_mesh.h"
#include "palpable/geometry/tet_mesh.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <cmath>
#include <utility>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::tolerance;

// A slab pressed everywhere on its top; how it gives way is known.
SnapshotStore pressed_slab(const std::filesystem::path& folder) {
  StoreContent content;
  content.name = "slab";
  content.mesh = box_tets({0, 0, 0}, {0.4, 0.1, 0.05}, 8, 4, 1);
  const Boundary boundary = split_boundary_of(content.mesh);
  const Index V = boundary.surface.vertices.cols(), N = content.mesh.node_count();
  content.fixed.assign(V, 0);
  for (Index v = 0; v < V; ++v) {
    if (boundary.surface.vertices(2, v) < 0.049) continue;
    content.sites.push_back({.vertex = static_cast<int>(v),
                             .patch = {static_cast<int>(v)},
                             .weights = {1.0f},
                             .direction = {0, 0, -1}});
  }
  content.levels = VectorXd::LinSpaced(5, 0.0, 1.0);
  content.keys.assign(content.sites.size(), 1);
  content.fields = {{"displacement", 3}};
  SnapshotStore store = SnapshotStore::create(folder, std::move(content));
  const StoreContent& known = store.content();
  for (int s = 0; s < known.site_count(); ++s) {
    const Eigen::Vector3d at = boundary.surface.vertices.col(known.sites[s].vertex);
    SiteSnapshots snapshots;
    snapshots.displacement.resize(3 * N, 4);
    snapshots.press_depth = known.levels;
    for (int l = 0; l < 4; ++l) {
      const double level = known.levels[l + 1], x = at.x() / 0.4, y = at.y() / 0.1;
      for (Index n = 0; n < N; ++n) {
        const Eigen::Vector3d X = known.mesh.nodes.col(n);
        snapshots.displacement(3 * n, l) = static_cast<float>(level * level * x * X.y());
        snapshots.displacement(3 * n + 1, l) =
            static_cast<float>(0.1 * level * (y - 0.5) * X.x() * X.x());
        snapshots.displacement(3 * n + 2, l) =
            static_cast<float>(-level * x * x * (3 - x) * X.x() * X.x());
      }
    }
    store.write(s, snapshots, Eigen::Matrix3Xd(3, 0));
  }
  return store;
}

TEST_CASE("a part of a campaign along a face says what the rest is", "[bake][sparse]") {
  const test::ScratchFolder scratch("sparse");
  const SnapshotStore store = pressed_slab(scratch / "store");
  const SparseCampaign result = sparse_campaign(store, {});
  CHECK(result.samples == 45 * 4);
  CHECK(result.trained_on == 54);
  CHECK(result.held_out <= tolerance(1e-4, "the field is three separated polynomials"));
  CHECK(result.held_out_median <= result.held_out_worst);
  // The error that it states is that of its model, here of one snapshot and all of them.
  const StoredField& field = *find_field(store.content(), "displacement");
  const SnapshotRows rows = snapshot_rows(store, 0, field);
  const VectorXd w = value_weights(store.content().mesh, field);
  const Boundary boundary = split_boundary_of(store.content().mesh);
  double lost = 0, whole = 0;
  for (int s = 0; s < 45; ++s) {
    const MatrixXd A = rows.read_first(s);
    for (Index l = 0; l < 4; ++l) {
      Eigen::Vector3d mu;
      const int vertex = store.content().sites[s].vertex;
      mu << boundary.surface.vertices.col(vertex).head(2), store.content().levels[l + 1];
      const VectorXd left = A.col(l) - result.model.F * result.model.functions(mu);
      lost += left.cwiseAbs2().dot(w);
      whole += A.col(l).cwiseAbs2().dot(w);
    }
  }
  CHECK(std::sqrt(lost / whole) <= 2.0 * result.held_out);
  CHECK(rows.read(5, 7) == [&] {
    MatrixXd all(7, 45 * 4);
    for (int s = 0; s < 45; ++s) all.middleCols(s * 4, 4) = rows.read_first(s).middleRows(5, 7);
    return all;
  }());
}

TEST_CASE("shear components of a stress count twice, and a node by its volume",
          "[bake][reduction]") {
  const TetMesh mesh = box_tets({0, 0, 0}, {1, 1, 1}, 1, 1, 1);
  const VectorXd volumes = nodal_volumes(mesh);
  const VectorXd u = value_weights(mesh, {"displacement", 3});
  const VectorXd sigma = value_weights(mesh, {"stress", 6});
  CHECK(std::abs(u.sum() - 3.0) <= tolerance(1e-12, "rounding"));
  CHECK(std::abs(sigma.sum() - 9.0) <= tolerance(1e-12, "rounding"));
  CHECK(u[3 * 2 + 1] == volumes[2]);
  CHECK(sigma[6 * 2 + 2] == volumes[2]);
  CHECK(sigma[6 * 2 + 3] == 2.0 * volumes[2]);
}

TEST_CASE("an incomplete campaign is not learnt from", "[bake][sparse]") {
  const test::ScratchFolder scratch("sparse-missing");
  const SnapshotStore store = pressed_slab(scratch / "store");
  std::filesystem::remove(store.unit_file(7));
  CHECK_THROWS_AS(sparse_campaign(store, {}), Error);
}

}  // namespace
}  // namespace palpable

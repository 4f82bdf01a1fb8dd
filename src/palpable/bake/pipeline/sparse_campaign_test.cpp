#include "palpable/bake/pipeline/sparse_campaign.h"

#include "palpable/bake/campaign/store_rows.h"
#include "palpable/bake/describe/body_mesh.h"
#include "palpable/bake/pipeline/bake_body.h"
#include "palpable/common/base/error.h"
#include "palpable/common/body_file/body_file.h"
#include "palpable/common/geometry/tet_mesh.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace palpable {
namespace {

using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::tolerance;

// A prescribed displacement of a slab of 0.4 x 0.1 x 0.05 m that is pressed at (x, y) of its top: a
// sum of three products. @param X  of a node at rest
Eigen::Vector3d known_displacement(const Eigen::Vector3d& at, double level,
                                   const Eigen::Vector3d& X) {
  const double x = at.x() / 0.4, y = at.y() / 0.1;
  return {level * level * (x + 0.1) * X.y(), 0.1 * level * (y - 0.5) * X.x() * X.x(),
          -level * x * x * (3 - x) * X.x() * X.x()};
}
// The prescribed stress, Pa.
Eigen::Matrix<double, 6, 1> known_stress(const Eigen::Vector3d& at, double level,
                                         const Eigen::Vector3d& X) {
  const double x = at.x() / 0.4;
  Eigen::Matrix<double, 6, 1> sigma;
  sigma << x * level, 0, X.x(), level * (x + 0.1), 0, X.z() * x;
  return 1e3 * level * sigma;
}

// A store of that slab, pressed at sites all over its top. @param turned  one site is pressed in
// another direction
SnapshotStore pressed_slab(const std::filesystem::path& folder, bool turned = false,
                           std::vector<StoredParameter> parameters = {}) {
  StoreContent content;
  content.name = "slab";
  content.material = "known";
  content.mesh = box_tets({0, 0, 0}, {0.4, 0.1, 0.05}, 8, 4, 1);
  const Boundary boundary = split_boundary_of(content.mesh);
  const Index V = boundary.surface.vertices.cols(), N = content.mesh.node_count();
  content.fixed.assign(V, 0);
  for (Index v = 0; v < V; ++v) {
    if (boundary.surface.vertices(0, v) < 1e-9) content.fixed[v] = 1;
    if (boundary.surface.vertices(2, v) < 0.049) continue;
    content.sites.push_back({.vertex = static_cast<int>(v),
                             .patch = {static_cast<int>(v)},
                             .weights = {1.0f},
                             .direction = {0, 0, -1}});
  }
  if (turned) content.sites[3].direction = Eigen::Vector3d(1, 0, 0);
  content.levels = VectorXd::LinSpaced(5, 0.0, 1.0);
  content.parameters = std::move(parameters);
  std::size_t points = 1;
  for (const StoredParameter& parameter : content.parameters) points *= parameter.values.size();
  content.keys.assign(points * content.sites.size(), 1);
  SnapshotStore store = SnapshotStore::create(folder, std::move(content));
  const StoreContent& known = store.content();
  for (int unit = 0; unit < known.unit_count(); ++unit) {
    const Eigen::Vector3d at =
        boundary.surface.vertices.col(known.sites[unit % known.site_count()].vertex);
    SiteSnapshots snapshots;
    snapshots.full_load = 2;
    snapshots.largest_von_mises = 1e3;
    snapshots.displacement.resize(3 * N, 4);
    snapshots.stress.resize(6 * N, 4);
    snapshots.press_depth = 0.01 * known.levels;
    for (int l = 0; l < 4; ++l) {
      for (Index n = 0; n < N; ++n) {
        const Eigen::Vector3d X = known.mesh.nodes.col(n);
        snapshots.displacement.col(l).segment<3>(3 * n) =
            known_displacement(at, known.levels[l + 1], X).cast<float>();
        snapshots.stress.col(l).segment<6>(6 * n) =
            known_stress(at, known.levels[l + 1], X).cast<float>();
      }
    }
    store.write(unit, snapshots, Eigen::Matrix3Xd(3, 0));
  }
  return store;
}

SparseCampaign learnt(const SnapshotStore& store, const SparseCampaignSettings& settings = {}) {
  return sparse_campaign(store, 0, *find_field(store.content(), "displacement"), settings);
}

TEST_CASE("a part of a campaign along a face predicts the rest", "[pipeline][sparse]") {
  const test::ScratchFolder scratch("sparse");
  const SnapshotStore store = pressed_slab(scratch / "store");
  const SparseCampaign result = learnt(store);
  CHECK(result.places.quantities);
  CHECK(result.places.axes.size() == 2);
  CHECK(result.all.count == 45 * 4);
  CHECK(result.trained_on == 54);
  CHECK(result.unseen.count == 45 * 4 - 54);
  CHECK(result.unseen.pooled <= tolerance(1e-4, "the field is three separated polynomials"));
  CHECK(result.unseen.median <= result.unseen.worst);
  // The stated errors are those of the model.
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
      const double mine = left.cwiseAbs2().dot(w), of = A.col(l).cwiseAbs2().dot(w);
      lost += mine;
      whole += of;
      CHECK(std::abs(std::sqrt(mine / of) - result.errors[s * 4 + l]) <=
            tolerance(1e-9, "rounding of what is left, 1e-16 of the whole, by its root"));
    }
  }
  CHECK(std::abs(std::sqrt(lost / whole) - result.all.pooled) <= tolerance(1e-9, "likewise"));
  CHECK(result.errors.maxCoeff() == result.all.worst);
  CHECK(rows.read(5, 7) == [&] {
    MatrixXd all(7, 45 * 4);
    for (int s = 0; s < 45; ++s) all.middleCols(s * 4, 4) = rows.read_first(s).middleRows(5, 7);
    return all;
  }());
}

TEST_CASE("a place is a quantity on a face and on a line, and else a choice",
          "[pipeline][sparse]") {
  const test::ScratchFolder scratch("sparse-places");
  StoreContent content = pressed_slab(scratch / "store").content();
  const Boundary boundary = split_boundary_of(content.mesh);
  std::vector<Site> line;
  for (const Site& site : content.sites) {
    if (boundary.surface.vertices(1, site.vertex) > 0.099) line.push_back(site);
  }
  const SitePlaces face = site_places(content);
  CHECK(face.axes[1].name == "y");
  CHECK(face.axes[1].high == 0.1);
  CHECK(face.points.cols() == 45);
  content.sites = line;
  const SitePlaces edge = site_places(content);
  CHECK((edge.quantities && edge.axes.size() == 1 && edge.axes[0].name == "x"));
  content.sites.push_back(content.sites[0]);
  for (Index v = 0; v < boundary.surface.vertices.cols(); ++v) {  // one in all three axes
    if (boundary.surface.vertices.col(v).norm() < 1e-9)
      content.sites.back().vertex = static_cast<int>(v);
  }
  CHECK_FALSE(site_places(content).quantities);
  content.sites = line;
  content.sites[1].direction = Eigen::Vector3d(0, 1, 0);
  const SitePlaces choices = site_places(content);
  CHECK_FALSE(choices.quantities);
  CHECK(choices.axes[0].choices == 9);
  content.sites.resize(1);
  CHECK_FALSE(site_places(content).quantities);
}

TEST_CASE("where sites are choices, snapshots of each site are learnt from", "[pipeline][sparse]") {
  const test::ScratchFolder scratch("sparse-choices");
  const SnapshotStore store = pressed_slab(scratch / "store", true);
  const SparseCampaign fewest = learnt(store, {.part = 50.0 / 180.0});
  CHECK(fewest.trained_on == 50);
  // A site without any training snapshot would have the function zero.
  CHECK(fewest.site_functions.rowwise().norm().minCoeff() >
        0.01 * fewest.site_functions.rowwise().norm().maxCoeff());
  const SparseCampaign half = learnt(store, {.part = 0.5});
  CHECK_FALSE(half.places.quantities);
  CHECK(half.unseen.pooled <= tolerance(0.2, "two snapshots a site: few modes survive validation"));
  CHECK_THROWS_WITH(learnt(store, {.part = 0.25}),
                    Contains("45; sparse PGD learns from at least 50"));
}

TEST_CASE("a part that is nothing or everything is refused", "[pipeline][sparse]") {
  const test::ScratchFolder scratch("sparse-parts");
  const SnapshotStore store = pressed_slab(scratch / "store");
  CHECK_THROWS_AS(learnt(store, {.part = 0.01}), Error);
  CHECK_THROWS_AS(learnt(store, {.part = 0.999}), Error);
}

// The largest difference between a body's field and the prescribed one, relative to the largest
// value of the latter.
template <int C, class Known>
double largest_difference(const ReducedBody& body, const SeparatedField& field,
                          const std::vector<double>& levels, const Known& known) {
  std::vector<float> values(field.value_count());
  double lost = 0, whole = 0;
  for (std::size_t s = 0; s < body.sites.size(); ++s) {
    const Eigen::Vector3d at = body.surface.vertices.col(body.sites[s].vertex);
    for (const double level : levels) {
      field.evaluate(std::array{static_cast<double>(s), level}, values);
      for (Index v = 0; v < body.surface.vertices.cols(); ++v) {
        const Eigen::Matrix<double, C, 1> truth = known(at, level, body.surface.vertices.col(v));
        const Eigen::Map<const Eigen::Matrix<float, C, 1>> mine(values.data() + C * v);
        lost = std::max(lost, (mine.template cast<double>() - truth).cwiseAbs().maxCoeff());
        whole = std::max(whole, truth.cwiseAbs().maxCoeff());
      }
    }
  }
  return lost / whole;
}

TEST_CASE("a body file holds what was learnt, at all sites and levels, and says how well",
          "[pipeline][sparse][body]") {
  for (const bool turned : {false, true}) {
    INFO("sites are " << (turned ? "choices" : "quantities"));
    const test::ScratchFolder scratch("sparse-body");
    const SnapshotStore store = pressed_slab(scratch / "store", turned);
    const double part = turned ? 0.5 : 0.3;
    const BakedBody baked = reduce_store(store, {.sparse = SparseCampaignSettings{.part = part}});
    write_body_file(scratch / "slab.palpable", baked.body);
    const ReducedBody body = value_or_throw(read_body_file(scratch / "slab.palpable"));
    CHECK(body.method == "sparse-pgd");
    CHECK(body.displacement.largest_block() == body.displacement.mode_count());
    const std::vector<double> levels{0.0, 0.25, 0.5, 0.6, 0.75, 1.0};
    CHECK(largest_difference<3>(body, body.displacement, levels, known_displacement) <=
          tolerance(turned ? 0.3 : 1e-3, "two snapshots a site teach little"));
    CHECK(largest_difference<6>(body, body.stress, levels, known_stress) <=
          tolerance(turned ? 0.3 : 1e-3, "likewise"));
    const ReductionReport& report = baked.report.displacement;
    CHECK(report.evaluated_worst <= tolerance(turned ? 0.3 : 1e-3, "likewise"));
    REQUIRE(report.learning.has_value());
    CHECK(report.learning->place == (turned ? "" : "x and y"));
    CHECK(report.learning->trained_on == (turned ? 90 : 54));
    CHECK(body.error.displacement_pooled == report.pooled);
    // Only the end of the course is known.
    REQUIRE(body.error.displacement_course.has_value());
    CHECK(body.error.displacement_course->modes.size() == 1);
    CHECK(body.error.displacement_course->modes[0] == body.displacement.mode_count());
    CHECK(body.error.displacement_course->snapshots.rows() == 45 * 4);
    REQUIRE(body.error.von_mises_course.has_value());
    CHECK_THAT(body.provenance.reduction,
               StartsWith("sparse-pgd (learnt from ") && Contains(" of 180") &&
                   Contains(turned ? "sites are choices" : "is a quantity, x and y"));
    CHECK_THAT(body.provenance.displacement, Contains("that it was not learnt from"));
    CHECK_THAT(body.provenance.stress, Contains("that it was not learnt from"));
  }
}

TEST_CASE("what is learnt depends on the seed, and on nothing else", "[pipeline][sparse]") {
  const test::ScratchFolder scratch("sparse-seed");
  const SnapshotStore store = pressed_slab(scratch / "store");
  const SparseCampaign one = learnt(store), again = learnt(store);
  CHECK(one.model.F == again.model.F);
  CHECK(one.unseen.pooled != learnt(store, {.seed = 2}).unseen.pooled);
}

TEST_CASE("nothing is learnt of an incomplete campaign, or over free parameters",
          "[pipeline][sparse]") {
  const test::ScratchFolder scratch("sparse-missing");
  const SnapshotStore store =
      pressed_slab(scratch / "store", false, {{"stiffness", VectorXd::LinSpaced(2, 1.0, 2.0)}});
  const SparseCampaignSettings sparse;
  CHECK_THROWS_WITH(reduce_store(store, {.sparse = sparse}), Contains("--set stiffness="));
  CHECK(reduce_store(store, {.sparse = sparse, .at = {{"stiffness", 2.0}}}).body.is_settled());
  std::filesystem::remove(store.unit_file(7));
  CHECK_THROWS_WITH(reduce_store(store, {.sparse = sparse, .at = {{"stiffness", 1.0}}}),
                    Contains("site_0007") || Contains("missing"));
}

TEST_CASE("shear components of a stress count twice, and a node by its volume",
          "[pipeline][reduction]") {
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

}  // namespace
}  // namespace palpable

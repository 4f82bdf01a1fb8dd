#include "palpable/campaign/between_sites.h"

#include "palpable/bake/bake_body.h"
#include "palpable/describe/body_mesh.h"
#include "palpable/geometry/mesh_file.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <algorithm>
#include <vector>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXf;
using test::tolerance;

TEST_CASE("touches lie between sites, evenly from the list, and are none themselves",
          "[bake][between]") {
  const SurfaceMesh skin = sphere_surface({0, 0, 0}, 1, 3);
  // Three sites within an eighth of the ball around its first vertex.
  const auto neighbours = vertex_neighbours(skin);
  const std::vector<int> near = graph_patch(neighbours, 0, 3);
  const std::vector<int> sites{near[0], near[near.size() / 2], near.back()};
  std::vector<int> all(static_cast<std::size_t>(skin.vertex_count()));
  for (std::size_t v = 0; v < all.size(); ++v) all[v] = static_cast<int>(v);
  const auto distance = [&](int a, int b) {
    return (skin.vertices.col(a) - skin.vertices.col(b)).norm();
  };
  double farthest = 0;
  for (const int a : sites) {
    double nearest = 10;
    for (const int b : sites) {
      if (a != b) nearest = std::min(nearest, distance(a, b));
    }
    farthest = std::max(farthest, nearest);
  }
  const std::vector<int> touches = touches_between(skin, sites, all, 100000);
  CHECK((touches.size() > 3 && touches.size() < all.size() / 2));
  for (const int v : all) {
    double nearest = 10;
    for (const int s : sites) nearest = std::min(nearest, distance(v, s));
    const bool listed = std::find(touches.begin(), touches.end(), v) != touches.end();
    CHECK(listed == (nearest > 0 && nearest <= farthest));
  }
  const std::vector<int> some = touches_between(skin, sites, all, 5);
  REQUIRE(some.size() == 5);
  for (std::size_t i = 0; i < 5; ++i) CHECK(some[i] == touches[i * touches.size() / 5]);
  CHECK(touches_between(skin, {4}, all, 5).empty());
}

TEST_CASE("a touch is compared with the nearest site's field of equal depth", "[bake][between]") {
  const SurfaceMesh skin = sphere_surface({0, 0, 0}, 1, 2);
  const auto neighbours = vertex_neighbours(skin);
  const int a = 0;
  Index far = 0;
  (skin.vertices.col(a).transpose() * skin.vertices).minCoeff(&far);
  const int b = static_cast<int>(far), near_a = neighbours[0].front();
  const Index V = skin.vertex_count();
  // Site a moves everything along x, site b along y. A touch beside a moves everything along x and
  // a tenth of that along z: its error is what is missing after both go equally far.
  MatrixXf sites = MatrixXf::Zero(3 * V, 2), touch = MatrixXf::Zero(3 * V, 1);
  for (Index v = 0; v < V; ++v) {
    sites(3 * v, 0) = 2;
    sites(3 * v + 1, 1) = 5;
    touch(3 * v, 0) = 7;
    touch(3 * v + 2, 0) = 0.7f;
  }
  const double long_side = std::sqrt(1.01);
  const double expected = std::hypot(1 - 1 / long_side, 0.1 / long_side);
  const BetweenSites one = between_sites(skin, {a, b}, sites, {near_a}, touch);
  CHECK(one.touches == 1);
  CHECK(one.median == Approx(expected).epsilon(tolerance(1e-6, "single precision")));
  CHECK(one.worst == one.median);
  // With the sites the other way round the nearest one is wrong altogether.
  const BetweenSites other = between_sites(skin, {b, a}, sites, {near_a}, touch);
  CHECK(other.median == Approx(std::sqrt(2.0)).epsilon(tolerance(1e-6, "single precision")));
}

TEST_CASE("a baked body says what a touch between its sites costs, and less with more sites",
          "[bake][between]") {
  const test::ScratchFolder folder("between");
  SurfaceMesh egg = sphere_surface({0, 0, 0}, 1, 3);
  egg.vertices.row(1) *= 1.3;
  write_ply(folder / "egg.ply", egg);
  BodyDescription description;
  description.name = "egg";
  description.source = folder / "egg.toml";
  description.shape = {.file = folder / "egg.ply", .up = UpAxis::kY, .height = 0.08, .edge = {}};
  description.material = {.law = "neo-hookean", .young = 40e3, .poisson = 0.35};
  description.supports = {{.where = {Where::Below{0.15}, "egg.toml:9: 'below' in [support]"}}};
  description.supports_place = "egg.toml:8: [support]";
  description.press = {.depth = 0.02, .levels = 2};
  const auto baked = [&](int count, bool linear) {
    description.sites = {.count = count, .above = 0.3, .patch = 1, .linear = linear};
    return bake_body(description, {.threads = 1, .version = {}, .command_line = {}});
  };
  const BakedBody few = baked(4, false), many = baked(40, false);
  REQUIRE(few.body.error.between_sites.has_value());
  REQUIRE(many.body.error.between_sites.has_value());
  CHECK(few.body.error.between_sites.value() > 1.5 * many.body.error.between_sites.value());
  CHECK(
      (many.body.error.between_sites.value() > 0.01 && few.body.error.between_sites.value() < 1.5));
  CHECK_FALSE(few.report.between_sites.empty());
  // All responses, or those that are needed: the same touches and the same figure.
  CHECK(baked(4, true).body.error.between_sites.value() == few.body.error.between_sites.value());
  CHECK_FALSE(baked(1, false).body.error.between_sites.has_value());
}

}  // namespace
}  // namespace palpable

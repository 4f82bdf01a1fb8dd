#include "palpable/bake/campaign/between_sites.h"

#include "palpable/bake/describe/contact_sites.h"
#include "tests/support/test.h"

#include <cmath>
#include <vector>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXf;
using test::tolerance;

TEST_CASE("a touch is compared with the nearest site's field of equal depth",
          "[campaign][between]") {
  const SurfaceMesh skin = sphere_surface({0, 0, 0}, 1, 2);
  const auto neighbours = vertex_neighbours(skin);
  const int a = 0;
  Index far = 0;
  (skin.vertices.col(a).transpose() * skin.vertices).minCoeff(&far);
  const int b = static_cast<int>(far), near_a = neighbours[0].front();
  const Index V = skin.vertex_count();
  // Site a moves everything along x, site b along y. A touch beside a moves everything along x and
  // a tenth of that along z: its error is the difference after both are scaled to equal depth.
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
  // With the sites exchanged, the field of the nearest site is perpendicular to that of the touch.
  const BetweenSites other = between_sites(skin, {b, a}, sites, {near_a}, touch);
  CHECK(other.median == Approx(std::sqrt(2.0)).epsilon(tolerance(1e-6, "single precision")));
}

}  // namespace
}  // namespace palpable

#include "palpable/bake/contact_sites.h"

#include "palpable/base/error.h"
#include "tests/support/test.h"

#include <limits>

namespace palpable {
namespace {

using test::tolerance;

struct Ball {
  SurfaceMesh skin = sphere_surface({0, 0, 0.05}, 0.05, 3);
  std::vector<std::uint8_t> fixed;
  Ball() {
    for (const auto& x : skin.vertices.colwise()) fixed.push_back(x[2] < 0.01);
  }
};

const SiteSettings kSettings{.count = 20, .lowest = 0.02, .patch_distance = 2};

TEST_CASE("sites lie above the line asked for and their patches clear of the support",
          "[bake][sites]") {
  const Ball ball;
  for (const double lowest : {0.0, 0.02, 0.06}) {
    INFO("lowest " << lowest);
    SiteSettings settings = kSettings;
    settings.lowest = lowest;
    for (const Site& site : choose_sites(ball.skin, ball.fixed, settings)) {
      CHECK(ball.skin.vertices(2, site.vertex) >= lowest);
      for (const int p : site.patch) CHECK(ball.fixed[static_cast<std::size_t>(p)] == 0);
    }
  }
}

TEST_CASE("patches carry weights that sum to one and loads point to the centre of mass",
          "[bake][sites]") {
  const Ball ball;
  const Eigen::VectorXd areas = vertex_areas(ball.skin);
  for (const Site& site : choose_sites(ball.skin, ball.fixed, kSettings)) {
    CHECK(site.patch.front() == site.vertex);
    CHECK(site.patch.size() >= 16);  // 1 + 5 + 10 around a vertex of valence five
    CHECK(site.patch.size() <= 19);  // 1 + 6 + 12 around one of valence six
    REQUIRE(site.weights.size() == site.patch.size());
    double sum = 0;
    for (std::size_t k = 0; k < site.patch.size(); ++k) {
      sum += site.weights[k];
      const double ratio = areas[site.patch[k]] / areas[site.vertex];
      CHECK(std::abs(site.weights[k] / site.weights[0] - ratio) <=
            tolerance(1e-5, "weights are single precision"));
    }
    CHECK(std::abs(sum - 1.0) <= tolerance(1e-5, "weights are single precision"));
    const Eigen::Vector3d inwards =
        (Eigen::Vector3d(0, 0, 0.05) - ball.skin.vertices.col(site.vertex)).normalized();
    CHECK((site.direction - inwards).norm() <= tolerance(1e-6, "the ball's own symmetry"));
  }
}

TEST_CASE("each site is the farthest from those before it", "[bake][sites]") {
  const Ball ball;
  SiteSettings settings = kSettings;
  settings.patch_distance = 0;
  const std::vector<Site> sites = choose_sites(ball.skin, ball.fixed, settings);
  const auto distance_to = [&](int v, std::size_t count) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t s = 0; s < count; ++s) {
      least = std::min(
          least, (ball.skin.vertices.col(v) - ball.skin.vertices.col(sites[s].vertex)).norm());
    }
    return least;
  };
  for (std::size_t s = 1; s < sites.size(); ++s) {
    INFO("site " << s);
    for (int v = 0; v < ball.skin.vertex_count(); ++v) {
      if (ball.skin.vertices(2, v) < settings.lowest || ball.fixed[std::size_t(v)]) continue;
      CHECK(distance_to(v, s) <= distance_to(sites[s].vertex, s));
    }
  }
}

TEST_CASE("the same skin has the same sites, and more sites begin with the fewer",
          "[bake][sites]") {
  const Ball ball;
  SiteSettings fewer = kSettings;
  fewer.count = 6;
  const auto a = choose_sites(ball.skin, ball.fixed, kSettings);
  const auto b = choose_sites(ball.skin, ball.fixed, kSettings);
  const auto c = choose_sites(ball.skin, ball.fixed, fewer);
  for (std::size_t s = 0; s < a.size(); ++s) CHECK(a[s].vertex == b[s].vertex);
  for (std::size_t s = 0; s < c.size(); ++s) CHECK(a[s].vertex == c[s].vertex);
}

TEST_CASE("more sites than vertices that may be one are refused", "[bake][sites]") {
  const Ball ball;
  SiteSettings settings = kSettings;
  settings.lowest = 0.0995;
  CHECK_THROWS_AS(choose_sites(ball.skin, ball.fixed, settings), Error);
  settings.lowest = 1.0;
  settings.count = 1;
  CHECK_THROWS_AS(choose_sites(ball.skin, ball.fixed, settings), Error);
}

}  // namespace
}  // namespace palpable

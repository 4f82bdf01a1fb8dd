#include "palpable/bake/describe/contact_sites.h"

#include "palpable/common/base/error.h"
#include "tests/support/test.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace palpable {
namespace {

using Catch::Contains;
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
          "[describe][sites]") {
  const Ball ball;
  for (const double lowest : {0.0, 0.02, 0.06}) {
    INFO("lowest " << lowest);
    SiteSettings settings = kSettings;
    settings.lowest = lowest;
    for (const Site& site : choose_sites(ball.skin, ball.fixed, settings)) {
      CHECK(ball.skin.vertices(2, site.vertex) >= lowest);
      for (const int p : site.patch) CHECK(ball.fixed[p] == 0);
    }
  }
}

TEST_CASE("patches carry weights that sum to one and loads point to the centre of mass",
          "[describe][sites]") {
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

TEST_CASE("each site is the farthest from those before it", "[describe][sites]") {
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
          "[describe][sites]") {
  const Ball ball;
  SiteSettings fewer = kSettings;
  fewer.count = 6;
  const auto a = choose_sites(ball.skin, ball.fixed, kSettings);
  const auto b = choose_sites(ball.skin, ball.fixed, kSettings);
  const auto c = choose_sites(ball.skin, ball.fixed, fewer);
  for (std::size_t s = 0; s < a.size(); ++s) CHECK(a[s].vertex == b[s].vertex);
  for (std::size_t s = 0; s < c.size(); ++s) CHECK(a[s].vertex == c[s].vertex);
}

TEST_CASE("a listed site keeps its place, and what is held of its patch carries nothing",
          "[describe][sites]") {
  const Ball ball;
  const std::vector<Site> chosen = choose_sites(ball.skin, ball.fixed, kSettings);
  const std::vector<Site> again =
      sites_at(ball.skin, ball.fixed, {chosen[3].vertex, chosen[1].vertex}, kSettings);
  REQUIRE(again.size() == 2);
  CHECK(again[0].vertex == chosen[3].vertex);
  CHECK(again[0].patch == chosen[3].patch);
  CHECK(again[1].weights == chosen[1].weights);

  // The lowest free vertex has held neighbours.
  int lowest = -1;
  for (int v = 0; v < ball.skin.vertex_count(); ++v) {
    if (ball.fixed[std::size_t(v)] != 0) continue;
    if (lowest < 0 || ball.skin.vertices(2, v) < ball.skin.vertices(2, lowest)) lowest = v;
  }
  const Site low = sites_at(ball.skin, ball.fixed, {lowest}, kSettings).front();
  CHECK(low.patch.size() < 16);
  float sum = 0;
  for (std::size_t k = 0; k < low.patch.size(); ++k) {
    CHECK(ball.fixed[std::size_t(low.patch[k])] == 0);
    sum += low.weights[k];
  }
  CHECK(sum == Approx(1.0f));
  const auto held = std::find(ball.fixed.begin(), ball.fixed.end(), 1) - ball.fixed.begin();
  CHECK_THROWS_WITH(sites_at(ball.skin, ball.fixed, {static_cast<int>(held)}, kSettings),
                    Catch::Matchers::Contains("lies on a node that [support] holds"));
}

TEST_CASE("loads point along the inward normal of the patch or the way that is given",
          "[describe][sites]") {
  const Ball ball;
  SiteSettings settings = kSettings;
  settings.direction = SiteDirection::kAlongNormal;
  for (const Site& site : choose_sites(ball.skin, ball.fixed, settings)) {
    const Eigen::Vector3d inwards =
        (Eigen::Vector3d(0, 0, 0.05) - ball.skin.vertices.col(site.vertex)).normalized();
    CHECK(site.direction.dot(inwards) >
          1.0 - tolerance(0.01, "a patch of a ball is nearly symmetric"));
  }
  settings.direction = SiteDirection::kGiven;
  settings.given = {0, 4, -3};
  for (const Site& site : choose_sites(ball.skin, ball.fixed, settings)) {
    CHECK(site.direction.isApprox(Eigen::Vector3d(0, 0.8, -0.6)));
  }
}

TEST_CASE("the areas that a load is shared by may be given", "[describe][sites]") {
  const Ball ball;
  SiteSettings settings = kSettings;
  settings.areas = Eigen::VectorXd::Zero(ball.skin.vertex_count());
  const int v = choose_sites(ball.skin, ball.fixed, kSettings).front().vertex;
  const Site alone = sites_at(ball.skin, ball.fixed, {v}, settings).front();
  CHECK(alone.weights.front() == 1.0f);  // all other areas are zero
  settings.areas[alone.patch[2]] = 3.0;
  settings.areas[alone.patch[5]] = 1.0;
  const Site two = sites_at(ball.skin, ball.fixed, {v}, settings).front();
  CHECK(two.weights[0] == 0.0f);
  CHECK(two.weights[2] == 0.75f);
  CHECK(two.weights[5] == 0.25f);
}

TEST_CASE("more sites than vertices that may be one are refused", "[describe][sites]") {
  const Ball ball;
  SiteSettings settings = kSettings;
  settings.lowest = 0.0995;
  CHECK_THROWS_WITH(choose_sites(ball.skin, ball.fixed, settings),
                    Contains("lie lower than 'above' in [sites] allows (0.0995 m)") &&
                        Contains("lower 'above'") && !Contains("[support]"));
  SiteSettings near = kSettings;
  near.lowest = -1.0;
  near.patch_distance = 20;
  CHECK_THROWS_WITH(choose_sites(ball.skin, ball.fixed, near),
                    Contains("'count' in [sites] is") &&
                        Contains("the patch ('patch' in [sites]: 20 edges around) reaches what "
                                 "[support] holds") &&
                        Contains("make 'patch' smaller") && !Contains("'above'"));
  settings.lowest = 1.0;
  settings.count = 1;
  CHECK_THROWS_AS(choose_sites(ball.skin, ball.fixed, settings), Error);
}

TEST_CASE("the salience of a sphere is one over its radius", "[describe][sites]") {
  const Eigen::VectorXd found = salience(sphere_surface({0, 0, 0}, 0.05, 3), 2);
  CHECK(std::abs(found.minCoeff() * 0.05 - 1.0) <= tolerance(0.05, "of 1,280 flat triangles"));
  CHECK(std::abs(found.maxCoeff() * 0.05 - 1.0) <= tolerance(0.05, "likewise"));
}

TEST_CASE("salient sites are where the skin is curved most, and apart", "[describe][sites]") {
  // The tips at +-Z have the radius of curvature a^2 / c = 6.7 mm, the waist has a = 20 mm around
  // and c^2 / a = 180 mm along.
  SurfaceMesh egg = sphere_surface({0, 0, 0}, 0.02, 3);
  egg.vertices.row(2) *= 3.0;
  const std::vector<std::uint8_t> fixed(std::size_t(egg.vertex_count()), 0);
  const auto choose = [&](int count) {
    return choose_sites(egg, fixed,
                        {.choice = SiteChoice::kSalient, .count = count, .lowest = -1.0});
  };
  const std::vector<Site> tips = choose(2);
  CHECK(std::abs(egg.vertices(2, tips[0].vertex)) > 0.05);
  CHECK(egg.vertices(2, tips[0].vertex) * egg.vertices(2, tips[1].vertex) < 0.0);
  const std::vector<Site> many = choose(30), again = choose(30);
  std::set<int> vertices;
  for (std::size_t s = 0; s < many.size(); ++s) {
    vertices.insert(many[s].vertex);
    CHECK(many[s].vertex == again[s].vertex);
  }
  CHECK(vertices.size() == 30);
  // All vertices, when as many sites are requested.
  CHECK(choose(egg.vertex_count()).size() == std::size_t(egg.vertex_count()));
}

}  // namespace
}  // namespace palpable

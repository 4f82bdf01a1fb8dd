#include "palpable/live/view/pressed_body.h"

#include "tests/support/bodies.h"
#include "tests/support/test.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

namespace palpable {
namespace {

TEST_CASE("a pressed body deforms at its site by the tabulated depth", "[view][pressed_body]") {
  const ReducedBody body = test::pressed_ball();
  PressedBody pressed(body);
  const BodyLook at_rest = pressed.look();
  const Eigen::Matrix3Xf before = *at_rest.vertices;
  CHECK(pressed.force() == 0);
  CHECK(pressed.largest_von_mises() == 0);
  for (const double level : {0.1, 0.5, 1.0}) {
    pressed.press(4, level);
    const Site& site = body.sites[4];
    const Eigen::Vector3f moved =
        pressed.look().vertices->col(site.vertex) - before.col(site.vertex);
    INFO("level " << level);
    CHECK(moved.dot(site.direction.cast<float>()) == Approx(0.01 * level).epsilon(1e-3));
    CHECK(pressed.force() == Approx(2.0 * level));
    CHECK(pressed.press_depth() ==
          Approx(level * body.press_depth(body.press_depth.rows() - 1, 4)));
    CHECK(pressed.largest_von_mises() == Approx(std::sqrt(3.0) * 1e3 * level).epsilon(1e-3));
  }
  pressed.press(4, 0);
  CHECK(*pressed.look().vertices == before);
}

TEST_CASE("a pressed body has the six components of its stress", "[view][pressed_body]") {
  const ReducedBody body = test::pressed_ball();
  PressedBody pressed(body);
  CHECK(std::all_of(pressed.cauchy().begin(), pressed.cauchy().end(),
                    [](float s) { return s == 0; }));
  pressed.press(4, 0.7);
  std::vector<float> mises(pressed.cauchy().size() / 6);
  von_mises(pressed.cauchy(), mises);
  const auto painted = pressed.look().scalar;
  CHECK(std::equal(painted.begin(), painted.end(), mises.begin(), mises.end()));
  CHECK(pressed.largest_von_mises() > 0);
}

TEST_CASE("the colour scale belongs to the site, not to how hard it is pressed",
          "[view][pressed_body]") {
  const ReducedBody body = test::pressed_ball();
  PressedBody pressed(body);
  pressed.press(2, 0.2);
  const float scale = pressed.look().scalar_max;
  pressed.press(2, 0.9);
  CHECK(pressed.look().scalar_max == scale);
  // At most 1 % of the vertices exceed the scale.
  pressed.press(2, 1.0);
  const auto stress = pressed.look().scalar;
  const auto above =
      std::count_if(stress.begin(), stress.end(), [&](float s) { return s > scale; });
  CHECK(above > 0);
  CHECK(static_cast<double>(above) <= 0.01 * static_cast<double>(stress.size()) + 1);
}

TEST_CASE("a click finds the site whose middle is nearest", "[view][pressed_body]") {
  const ReducedBody body = test::pressed_ball();
  PressedBody pressed(body);
  for (int s = 0; s < static_cast<int>(body.sites.size()); ++s) {
    const Eigen::Vector3d middle = body.surface.vertices.col(body.sites[s].vertex);
    CHECK(pressed.nearest_site(middle + Eigen::Vector3d(0.002, -0.001, 0.003)) == s);
  }
}

TEST_CASE("patches are marked and each site has its dot", "[view][pressed_body]") {
  const ReducedBody body = test::pressed_ball();
  PressedBody pressed(body);
  std::set<int> in_patches;
  for (const Site& site : body.sites) in_patches.insert(site.patch.begin(), site.patch.end());
  for (int v = 0; v < body.surface.vertex_count(); ++v) {
    CHECK(pressed.patch_marks()[v] == (in_patches.contains(v) ? 1 : 0));
  }
  std::vector<Dot> dots;
  pressed.site_dots(0.001f, dots);
  REQUIRE(dots.size() == body.sites.size());
  CHECK(dots[3].at_in_body.isApprox(
      body.surface.vertices.col(body.sites[3].vertex).cast<float>().eval()));
  CHECK(dots[3].color == Rgb{240, 120, 20});
  // The row of dots lies outside of the body, on the line of the load.
  dots.clear();
  pressed.press(4, 0.5);
  pressed.load_dots(0.001f, dots);
  for (const Dot& dot : dots)
    CHECK(dot.at_in_body.z() > pressed.look().vertices->row(2).maxCoeff() - 0.006f);
  CHECK(dots.front().at_in_body.z() < dots.back().at_in_body.z());
}

TEST_CASE("the sites to show are different ones, the highest first", "[view][pressed_body]") {
  const ReducedBody body = test::pressed_ball();
  const std::vector<int> three = sites_to_show(body, 3);
  CHECK(three.size() == 3);
  CHECK(three.front() == 4);
  CHECK(std::set<int>(three.begin(), three.end()).size() == 3);
  CHECK(sites_to_show(body, 50).size() == body.sites.size());
}

}  // namespace
}  // namespace palpable

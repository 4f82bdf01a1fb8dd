#include "palpable/live/view/body_pictures.h"

#include "palpable/live/render/gl_context.h"
#include "tests/support/bodies.h"
#include "tests/support/test.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

namespace palpable {
namespace {

constexpr PictureSize kSize{160, 96};

TEST_CASE("presses are drawn under different names, and then on one sheet",
          "[view][body_pictures]") {
  const Result<GlContext> context = GlContext::offscreen();
  if (!context.ok()) PALPABLE_SKIP(context.problem().message);
  const ReducedBody body = test::pressed_ball();
  std::vector<std::string> names;
  std::vector<ColorImage> pictures;
  const auto keep = [&](const std::string& name, const ColorImage& picture) {
    names.push_back(name);
    pictures.push_back(picture);
  };
  draw_presses(body, 4, 0.9, kPaints[0], ColorScale::kBlueYellow, kSize, keep);
  CHECK(names == std::vector<std::string>{"1_at_rest", "2_sites", "3_press_site_4_level_30",
                                          "4_press_site_4_level_60", "5_press_site_4_level_90",
                                          "6_sites_from_behind", "contact_sheet"});
  for (int i = 0; i < 6; ++i) CHECK(pictures[i].width() == 160);
  const ColorImage& sheet = pictures.back();
  CHECK(sheet.width() == 3 * 80 + 4 * 8);
  CHECK(sheet.height() == 2 * 48 + 3 * 8);
  CHECK_FALSE(std::equal(pictures[2].begin(), pictures[2].end(), pictures[4].begin()));
  // Other colours: the pressed body looks different, the body at rest shows its material alone.
  const std::vector<ColorImage> usual = pictures;
  pictures.clear();
  draw_presses(body, 4, 0.9, kPaints[0], ColorScale::kGray, kSize, keep);
  CHECK(pictures[0] == usual[0]);
  CHECK_FALSE(pictures[4] == usual[4]);
  names.clear();
  draw_presses(body, -1, 1.0, kPaints[0], ColorScale::kBlueYellow, kSize, keep);
  CHECK(names.size() == 7);
  CHECK(std::set<std::string>(names.begin(), names.end()).size() == 7);
  CHECK(context.value().errors().count() == 0);
}

TEST_CASE("a body without stress is pressed without legend, colours or a stress of 0",
          "[view][studio_scene]") {
  const Result<GlContext> context = GlContext::offscreen();
  if (!context.ok()) PALPABLE_SKIP(context.problem().message);
  ReducedBody body = test::pressed_ball();
  const auto pressed_with = [&](bool legend) {
    StudioScene scene(body, kSize);
    scene.pressed().press(0, 1.0);
    scene.legend_shown = legend;
    CHECK((scene.reading().find("kPa") != std::string::npos) == (body.largest_von_mises > 0));
    return scene.draw(usual_camera(body, kSize.aspect()));
  };
  CHECK_FALSE(pressed_with(true) == pressed_with(false));
  body.largest_von_mises = 0;  // as modes of another program without stress
  CHECK(pressed_with(true) == pressed_with(false));
}

TEST_CASE("a pixel of the picture leads back to the body's skin, one beside it to nothing",
          "[view][studio_scene]") {
  const Result<GlContext> context = GlContext::offscreen();
  if (!context.ok()) PALPABLE_SKIP(context.problem().message);
  const ReducedBody body = test::pressed_ball(0.05);
  StudioScene scene(body, kSize);
  scene.draw(usual_camera(body, kSize.aspect()));
  CHECK_FALSE(scene.point_at(0, 0));
  CHECK_FALSE(scene.point_at(-5, 48));
  const auto point = scene.point_at(80, 48);
  REQUIRE(point.has_value());
  CHECK((*point - Eigen::Vector3d(0, 0, 0.05)).norm() ==
        Approx(0.05).epsilon(test::tolerance(0.02, "the ball is a polyhedron")));
}

}  // namespace
}  // namespace palpable

#include "palpable/live/view/sensed_picture.h"

#include "palpable/live/render/color_map.h"
#include "tests/support/test.h"

#include <cmath>

namespace palpable {
namespace {

// 64 x 48 px, depth and masks of half the size: unknown, then too close, then 0.15, 0.5, 2, 9 m.
Scene scene_of_six() {
  Scene scene;
  scene.seen.color = ColorImage(64, 48, {90, 120, 150});
  scene.seen.depth = DepthImage(32, 24, std::nanf(""));
  scene.seen.too_close = MaskImage(32, 24, 0);
  const float Z[] = {NAN, NAN, 0.15f, 0.5f, 2.0f, 9.0f};
  for (int i = 0; i < 6; ++i) scene.seen.depth(3 * i, 2) = Z[i];
  scene.seen.too_close(3, 2) = 255;
  return scene;
}

TEST_CASE("near depths are bright, far ones dark, and what is not known has colours of its own",
          "[view][sensed_picture]") {
  ColorImage picture;
  draw_depth(scene_of_six(), picture);
  REQUIRE(picture.width() == 64);
  REQUIRE(picture.height() == 48);
  const auto at = [&](int i) { return picture(6 * i + 1, 5); };
  CHECK(at(2) == color_of_share(1));
  CHECK(at(4) == color_of_share(0));
  CHECK(at(5) == color_of_share(0));  // beyond the scale
  const float middle = (1 / 0.5f - 1 / 2.0f) / (1 / 0.15f - 1 / 2.0f);
  CHECK(std::abs(at(3).r - color_of_share(middle).r) <= 2);
  CHECK(at(0).r == at(0).g);  // grey
  CHECK(at(1).r > 200);       // red
  CHECK(at(1).g < 60);
}

TEST_CASE("what moves is orange and everything else dark", "[view][sensed_picture]") {
  Scene scene = scene_of_six();
  scene.moving = MaskImage(32, 24, 0);
  scene.moving(10, 2) = 255;
  ColorImage picture;
  draw_moving(scene, picture);
  CHECK(picture(21, 5) == Rgb{172, 120, 75});  // the mean of the frame and of 255 120 0
  CHECK(picture(40, 5) == Rgb{30, 40, 50});
  scene.moving = {};  // the camera is lost
  draw_moving(scene, picture);
  CHECK(picture(21, 5) == Rgb{30, 40, 50});
}

}  // namespace
}  // namespace palpable

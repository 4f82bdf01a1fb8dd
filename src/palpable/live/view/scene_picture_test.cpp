#include "palpable/live/view/scene_picture.h"

#include "palpable/live/session/frame_loop.h"
#include "palpable/live/view/painted_stress.h"
#include "palpable/live/view/show_names.h"
#include "tests/support/dented_sphere.h"
#include "tests/support/seen_wall.h"
#include "tests/support/test.h"

#include <algorithm>
#include <utility>

namespace palpable {
namespace {

// A sphere pressed on its top by a finger with 2 N, 10 mm deep.
struct Pressed {
  FrameLoop loop = [] {
    Rigid3 camera_from_body = Rigid3::Identity();
    camera_from_body.linear() << 1, 0, 0, 0, 0, -1, 0, 1, 0;  // Z up in the picture
    camera_from_body.translation() = Eigen::Vector3d(0, 0.05, 0.4);
    return value_or_throw(FrameLoop::make(test::DentedSphere{}.body(), camera_from_body,
                                          test::wall_format(),
                                          {.press_static = true, .map = false}));
  }();
  Scene scene = loop.process(test::frame_of_wall(0, 0));
  SceneViews views{10e3};

  Pressed() {
    Touch touch;
    touch.force = 2;
    touch.press_depth = 0.01;
    touch.point_in_body = {0, 0, 0.09};
    touch.direction = {0, 0, -1};
    scene.touches = {touch};
    scene.bodies.front().stated_error = StatedError{0.03, 0.12};
  }
};

TEST_CASE("a colour scale is chosen by its name, and every body gets it", "[view]") {
  const auto named = [](const char* name) {
    return value_named<ColorScale>(name, kColorScaleNames);
  };
  CHECK(named("blue-yellow") == ColorScale::kBlueYellow);
  CHECK(named("viridis") == ColorScale::kViridis);
  CHECK(named("rainbow") == ColorScale::kRainbow);
  CHECK(named("gray") == ColorScale::kGray);
  Pressed pressed;
  SceneShow show;
  show.colors = ColorScale::kViridis;
  const SceneView& view = pressed.views.of(pressed.scene, pressed.loop.session, show);
  CHECK(view.bodies.front().colors == ColorScale::kViridis);
}

TEST_CASE("stress, displacement or the material alone is painted", "[view]") {
  Pressed pressed;
  SceneShow show;
  const SceneView& view = pressed.views.of(pressed.scene, pressed.loop.session, show);
  CHECK(view.bodies.front().scalar.data() == pressed.scene.bodies.front().von_mises.data());
  CHECK(view.legend_title == "von Mises");
  CHECK(view.stated_error == 0.12);

  SceneBody& body = pressed.scene.bodies.front();
  body.vertices.col(7) += Eigen::Vector3f(0, 0.003f, -0.004f);
  show.field = SceneShow::Field::kDisplacement;
  pressed.views.of(pressed.scene, pressed.loop.session, show);
  const std::span<const float> moved = view.bodies.front().scalar;
  CHECK(moved[7] == Approx(0.005).epsilon(1e-3));
  CHECK(*std::max_element(moved.begin(), moved.end()) == moved[7]);
  CHECK(view.bodies.front().scalar_max == Approx(0.01).epsilon(0.01));  // a tenth of its height
  CHECK(view.legend_title == "displacement");
  CHECK(view.legend_unit == "mm");
  CHECK(view.stated_error == 0.03);

  show.field = SceneShow::Field::kContact;
  body.contact_pressure.assign(static_cast<std::size_t>(body.vertices.cols()), 5e3f);
  pressed.views.of(pressed.scene, pressed.loop.session, show);
  CHECK(view.bodies.front().scalar.data() == body.contact_pressure.data());
  CHECK(view.bodies.front().scalar_max == Approx(kContactOfStress * 10e3));
  CHECK(view.legend_unit == "kPa");
  CHECK(view.legend_title == kNoContactKnown);  // this body has sites alone
  CHECK(view.stated_error == 0);

  show.field = SceneShow::Field::kNone;
  pressed.views.of(pressed.scene, pressed.loop.session, show);
  CHECK(view.bodies.front().scalar.empty());
  CHECK(view.legend_title.empty());
}

TEST_CASE("pressure and components are painted on a scale of two sides, of von Mises' length",
          "[view]") {
  Pressed pressed;
  SceneBody& body = pressed.scene.bodies.front();
  body.cauchy.assign(6 * body.von_mises.size(), 0.0f);
  for (int c = 0; c < 3; ++c) body.cauchy[6 * 7 + static_cast<std::size_t>(c)] = -2e3f;
  SceneShow show;
  show.field = SceneShow::Field::kPressure;
  const SceneView& view = pressed.views.of(pressed.scene, pressed.loop.session, show);
  const BodyLook& look = view.bodies.front();
  CHECK(look.two_sided);
  CHECK(look.scalar_max == 10e3f);
  REQUIRE(look.scalar.size() == body.von_mises.size());
  CHECK(look.scalar[7] == 2e3f);
  CHECK(look.scalar[8] == 0);
  CHECK(view.legend_title == "pressure");
  CHECK(view.legend_unit == "kPa");
  CHECK(view.stated_error == 0.12);
  CHECK(view.stated_error_of == "stress");

  show.field = SceneShow::Field::kComponent;
  show.component = SceneShow::Component::kYy;
  pressed.views.of(pressed.scene, pressed.loop.session, show);
  CHECK(look.scalar[7] == -2e3f);
  CHECK(view.legend_title == "stress yy");
  show.legend = false;
  pressed.views.of(pressed.scene, pressed.loop.session, show);
  CHECK(view.legend_title.empty());

  // The next field has a one-sided scale again.
  pressed.views.of(pressed.scene, pressed.loop.session, {});
  CHECK_FALSE(look.two_sided);
  CHECK(view.stated_error_of.empty());
}

TEST_CASE("a body whose file holds no stress says so instead of a pressure of 0", "[view]") {
  ReducedBody silent = test::DentedSphere{}.body();
  silent.largest_von_mises = 0;  // as modes of another program without stress
  Rigid3 camera_from_body = Rigid3::Identity();
  camera_from_body.translation() = Eigen::Vector3d(0, 0.05, 0.4);
  FrameLoop loop =
      value_or_throw(FrameLoop::make(std::move(silent), camera_from_body, test::wall_format(),
                                     {.press_static = true, .map = false}));
  loop.session.keep({.components = true});
  SceneShow show;
  show.field = SceneShow::Field::kPressure;
  SceneViews views{10e3};
  const SceneView& view = views.of(loop.process(test::frame_of_wall(0, 0)), loop.session, show);
  CHECK(view.bodies.front().scalar.empty());
  CHECK(view.legend_title == kNoStressKnown);
  // Usually the von Mises stress is painted: a scale of zeros would show nothing.
  const SceneView& usual = views.of(loop.process(test::frame_of_wall(1, 0)), loop.session, {});
  CHECK(usual.legend_title.empty());
}

TEST_CASE("occlusion is soft, hard or none, and gets what is known to move", "[view]") {
  Pressed pressed;
  SceneShow show;
  const SceneView& view = pressed.views.of(pressed.scene, pressed.loop.session, show);
  CHECK(view.real_depth == &pressed.scene.seen.depth);
  CHECK_FALSE(view.hard_occlusion);
  pressed.scene.moving = MaskImage();
  pressed.views.of(pressed.scene, pressed.loop.session, show);
  CHECK(view.moving == nullptr);
  CHECK(view.borrowed == nullptr);
  const DepthImage& depth = pressed.scene.seen.depth;
  pressed.scene.moving = pressed.scene.seen.too_close = pressed.scene.borrowed =
      MaskImage(depth.width(), depth.height(), 0);
  show.occlusion = SceneShow::Occlusion::kHard;
  pressed.views.of(pressed.scene, pressed.loop.session, show);
  CHECK(view.real_depth == &depth);
  CHECK(view.hard_occlusion);
  CHECK(view.moving == &pressed.scene.moving);
  CHECK(view.borrowed == &pressed.scene.borrowed);
  CHECK(view.too_close == &pressed.scene.seen.too_close);
  show.occlusion = SceneShow::Occlusion::kNone;
  pressed.views.of(pressed.scene, pressed.loop.session, show);
  CHECK(view.real_depth == nullptr);
}

TEST_CASE("touches are shown where they are, on request", "[view]") {
  Pressed pressed;
  SceneShow show;
  const SceneView& view = pressed.views.of(pressed.scene, pressed.loop.session, show);
  CHECK(view.arrows.empty());
  CHECK(view.bodies.front().dots.empty());
  show.contacts = show.forces = true;
  pressed.views.of(pressed.scene, pressed.loop.session, show);
  REQUIRE(view.arrows.size() == 1);
  const Rigid3& camera_from_body = pressed.scene.bodies.front().camera_from_body;
  const Arrow& arrow = view.arrows.front();
  CHECK(arrow.tip.isApprox(camera_from_body * Eigen::Vector3d(0, 0, 0.09)));
  CHECK(arrow.tail.y() < arrow.tip.y());  // it comes from above
  CHECK(arrow.label == "2.00 N");
  REQUIRE(view.bodies.front().dots.size() == 1);
  CHECK(view.bodies.front().dots.front().at_in_body.isApprox(Eigen::Vector3f(0, 0, 0.09f)));
  // A stronger force gives a longer arrow, up to a limit.
  const double length = (arrow.tip - arrow.tail).norm();
  const auto length_at = [&](double force) {
    pressed.scene.touches.front().force = force;
    pressed.views.of(pressed.scene, pressed.loop.session, show);
    return (view.arrows.front().tip - view.arrows.front().tail).norm();
  };
  CHECK(length_at(4) > length);
  CHECK(length_at(400) == Approx(length_at(40)));

  // All touches have balls, but only the strongest have arrows.
  pressed.scene.touches.resize(12, pressed.scene.touches.front());
  for (std::size_t i = 1; i < 12; ++i) pressed.scene.touches[i].force = i < 3 ? 100 : 1;
  pressed.views.of(pressed.scene, pressed.loop.session, show);
  CHECK(view.arrows.size() == 3);
  CHECK(view.bodies.front().dots.size() == 12);
}

}  // namespace
}  // namespace palpable

#include "palpable/live/map/static_picture.h"

#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

namespace palpable {
namespace {

constexpr int kWidth = 96, kHeight = 56, kTiles = 24, kRows = 14;
using Look = StaticPicture::Look;

// A coloured, textured scene, twice as large as the depth image, with noise of `noise` grey levels.
struct Camera {
  explicit Camera(unsigned seed, double noise_levels = 0.7)
      : random(test::random_case(seed)), noise(noise_levels) {
    std::uniform_real_distribution<double> any(90, 150);
    for (auto& value : scene) value = any(random);
  }

  // Takes one frame. `thing` may change the light (r, g, b) that comes from a pixel.
  template <class Thing>
  void see(const Thing& thing) {
    std::normal_distribution<double> normal(0, noise);
    luma.resize(2 * kWidth, 2 * kHeight);
    color.resize(2 * kWidth, 2 * kHeight);
    for (int y = 0; y < 2 * kHeight; ++y) {
      for (int x = 0; x < 2 * kWidth; ++x) {
        const double s = scene[(y / 3) * 2 * kWidth + x];
        std::array<double, 3> light{s, 0.8 * s, 0.6 * s};
        thing(x / 2, y / 2, light);
        const double n = normal(random);
        const auto level = [&](double v) {
          return static_cast<std::uint8_t>(std::clamp(std::lround(v + n), 0L, 255L));
        };
        color(x, y) = {level(light[0]), level(light[1]), level(light[2])};
        luma(x, y) = level(0.3 * light[0] + 0.59 * light[1] + 0.11 * light[2]);
      }
    }
  }
  void see() {
    see([](int, int, auto&) {});
  }

  std::mt19937_64 random;
  double noise;
  std::array<double, static_cast<std::size_t>(4 * kWidth * kHeight)> scene{};
  GrayImage luma;
  ColorImage color;
};

struct Watch {
  bool compare(const Camera& camera) {
    return picture.compare(camera.luma, camera.color, kWidth, kHeight, all);
  }
  void learn(Camera& camera, int frames) {
    for (int k = 0; k < frames; ++k) {
      camera.see();
      REQUIRE(compare(camera));
      picture.learn(none, all);
    }
  }
  // The number of tiles with this look, inside the tests' thing (columns 6 .. 11, rows 4 .. 7) or
  // outside.
  [[nodiscard]] int count(Look look, bool inside) const {
    int n = 0;
    for (int j = 0; j < kRows; ++j) {
      for (int i = 0; i < kTiles; ++i) {
        n += inside == in_thing(4 * i, 4 * j) && picture.tile(i, j) == look ? 1 : 0;
      }
    }
    return n;
  }
  static bool in_thing(int x, int y) { return x >= 24 && x < 48 && y >= 16 && y < 32; }

  StaticPicture picture;
  Image<std::uint8_t> all = Image<std::uint8_t>(kTiles, kRows, 1);
  Image<std::uint8_t> none = Image<std::uint8_t>(kTiles, kRows, 0);
};

constexpr int kInside = 6 * 4, kOutside = kTiles * kRows - kInside;

TEST_CASE("a scene at rest looks the same, bright or dark", "[map][static_picture]") {
  for (unsigned seed = 0; seed < 6; ++seed) {
    INFO("seed " << seed);
    Camera camera(seed, seed < 3 ? 0.7 : 3.0);
    Watch watch;
    watch.learn(camera, 40);
    int same = 0;
    for (int k = 0; k < 20; ++k) {
      camera.see();
      watch.compare(camera);
      same += watch.count(Look::kSame, true) + watch.count(Look::kSame, false);
      CHECK(watch.count(Look::kChanged, true) + watch.count(Look::kChanged, false) == 0);
      watch.picture.learn(watch.none, watch.all);
    }
    CHECK(same >=
          test::tolerance(0.99, "bounds of three and four deviations") * 20 * kTiles * kRows);
  }
}

TEST_CASE("a thing of another colour has changed, whatever the exposure", "[map][static_picture]") {
  unsigned seed = 10;
  for (const double gain : {1.0, 0.7, 1.4}) {
    INFO("gain " << gain);
    Camera camera(seed++);
    Watch watch;
    watch.learn(camera, 20);
    camera.see([&](int x, int y, auto& light) {
      if (Watch::in_thing(x, y)) light = {200, 150, 140};
      for (double& part : light) part *= gain;
    });
    watch.compare(camera);
    CHECK(watch.count(Look::kChanged, true) == kInside);
    CHECK(watch.count(Look::kChanged, false) == 0);
    CHECK_FALSE(watch.picture.is_same_pixel(36, 24));
    CHECK(watch.picture.is_same_pixel(60, 24));
    CHECK_FALSE(watch.picture.is_same_pixel(60, 0));  // at the border its neighbours are not known
  }
}

TEST_CASE("a shadow is told from a thing that is as dark", "[map][static_picture]") {
  Camera camera(20);
  Watch watch;
  watch.learn(camera, 20);
  camera.see([&](int x, int y, auto& light) {
    if (!Watch::in_thing(x, y)) return;
    if (x < 36) {
      for (double& part : light) part *= 0.6;
    } else {
      light = {60, 75, 70};
    }
  });
  watch.compare(camera);
  CHECK(watch.count(Look::kShadow, true) == kInside / 2);
  CHECK(watch.count(Look::kChanged, true) == kInside / 2);
  CHECK(watch.count(Look::kShadow, false) + watch.count(Look::kChanged, false) == 0);
}

TEST_CASE("what is darker than any shadow is a thing, although its hue is the scene's",
          "[map][static_picture]") {
  Camera camera(25);
  Watch watch;
  watch.learn(camera, 20);
  camera.see([&](int x, int y, auto& light) {
    if (!Watch::in_thing(x, y)) return;
    for (double& part : light) part *= 0.2;
  });
  watch.compare(camera);
  CHECK(watch.count(Look::kChanged, true) == kInside);
  CHECK(watch.count(Look::kShadow, false) + watch.count(Look::kChanged, false) == 0);
}

// Light `level` and noise of a bright and of a dark room.
struct Room {
  double level, noise;
};
constexpr std::array<Room, 2> kRooms{{{1.0, 0.7}, {0.2, 2.0}}};

Camera camera_in(const Room& room, unsigned seed) {
  Camera camera(seed, room.noise);
  for (double& value : camera.scene) value *= room.level;
  return camera;
}

TEST_CASE("a thing is told by its hue where its shading passes through the scene's level",
          "[map][static_picture]") {
  unsigned seed = 60;
  for (const Room& room : kRooms) {
    INFO("level " << room.level);
    Camera camera = camera_in(room, seed++);
    Watch watch;
    watch.learn(camera, 40);
    camera.see([&](int x, int y, auto& light) {
      if (!Watch::in_thing(x, y)) return;
      if (x < 36) {
        for (double& part : light) part *= 1.6;
      } else {
        light[2] *= 1.25;  // 2 % of the luma
      }
    });
    watch.compare(camera);
    CHECK(watch.count(Look::kChanged, true) == kInside / 2);  // its depth is the scene's
    for (int j = 0; j < kRows; ++j) {
      for (int i = 0; i < kTiles; ++i) {
        if (Watch::in_thing(4 * i, 4 * j)) watch.all(i, j) = 0;
      }
    }
    watch.compare(camera);
    CHECK(watch.count(Look::kChanged, true) == kInside);
    CHECK(watch.count(Look::kChanged, false) == 0);
  }
}

TEST_CASE("a shadow is told from a thing in the dark, and does not stay in the picture",
          "[map][static_picture]") {
  unsigned seed = 70;
  for (const Room& room : kRooms) {
    INFO("level " << room.level);
    Camera camera = camera_in(room, seed++);
    Watch watch;
    watch.learn(camera, 40);
    // The shadow takes away the sun's shares of red, green and blue.
    const auto shade = [&](int x, int y, auto& light) {
      if (Watch::in_thing(x, y)) light = {0.58 * light[0], 0.6 * light[1], 0.63 * light[2]};
    };
    for (int k = 0; k < 60; ++k) {
      camera.see(shade);
      watch.compare(camera);
      watch.picture.learn(watch.none, watch.all);
    }
    CHECK(watch.count(Look::kShadow, true) == kInside);
    camera.see();
    watch.compare(camera);
    CHECK(watch.count(Look::kChanged, true) + watch.count(Look::kChanged, false) == 0);
  }
}

TEST_CASE("a view may be off by a pixel, a thing may not", "[map][static_picture]") {
  Camera camera(80);
  Watch watch;
  PictureView view{GrayImage(kWidth, kHeight), Image<TileColor>(kTiles, kRows),
                   Image<std::uint8_t>(kTiles, kRows, 1), Image<std::uint8_t>(kTiles, kRows, 1)};
  const auto compare = [&] {
    return watch.picture.compare(camera.luma, camera.color, kWidth, kHeight, watch.all, view);
  };
  camera.see();
  view.known = watch.none;
  REQUIRE(compare());
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      view.luma(x, y) = watch.picture.luma()(std::max(x - 1, 0), std::min(y + 1, kHeight - 1));
    }
  }
  for (int j = 0; j < kRows; ++j) {
    for (int i = 0; i < kTiles; ++i) view.colors(i, j) = *watch.picture.color(i, j);
  }
  view.known = watch.all;
  for (const double gain : {1.0, 0.7}) {
    INFO("gain " << gain);
    camera.see([&](int x, int y, auto& light) {
      if (Watch::in_thing(x, y)) light = {200, 150, 140};
      for (double& part : light) part *= gain;
    });
    REQUIRE(compare());
    CHECK(watch.count(Look::kChanged, true) == kInside);
    CHECK(watch.count(Look::kSame, false) >=
          test::tolerance(0.98, "bounds of three and four deviations") * kOutside);
  }
}

TEST_CASE("what moves is not learnt, what stays is after a while", "[map][static_picture]") {
  Camera camera(30);
  Watch watch;
  StaticPictureSettings settings;
  settings.frames_to_settle = 60;
  watch.picture = StaticPicture(settings);
  watch.learn(camera, 20);
  camera.see();
  watch.compare(camera);
  CHECK(watch.picture.looks_as_ever(8, 5));
  Image<std::uint8_t> moves(kTiles, kRows), scene(kTiles, kRows, 1);
  for (int j = 4; j < 8; ++j) {
    for (int i = 6; i < 12; ++i) moves(i, j) = 1;
  }
  const auto show = [&](int frames) {
    for (int k = 0; k < frames; ++k) {
      camera.see([&](int x, int y, auto& light) {
        if (Watch::in_thing(x, y)) light = {200, 150, 140};
      });
      watch.compare(camera);
      watch.picture.learn(moves, scene);
    }
  };
  show(59);
  CHECK(watch.count(Look::kChanged, true) == kInside);
  CHECK_FALSE(watch.picture.looks_as_ever(8, 5));
  // The thing is taken over, and looks the same for five times six frames.
  show(1 + 29 + 1);
  CHECK(watch.count(Look::kSame, true) >= kInside - 1);
  // The look may be that of a new object.
  CHECK_FALSE(watch.picture.looks_as_ever(8, 5));
  CHECK(watch.picture.looks_as_ever(2, 10));
  // With the scene's depth and without motion it takes frames_to_renew frames.
  for (int k = 0; k < settings.frames_to_renew; ++k) {
    camera.see();
    watch.compare(camera);
    CHECK(watch.count(Look::kChanged, true) == kInside);
    watch.picture.learn(watch.none, scene);
  }
  watch.learn(camera, 7);
  CHECK(watch.count(Look::kSame, true) >= kInside - 1);
}

TEST_CASE("a moved camera, strange sizes and the first frames say nothing",
          "[map][static_picture]") {
  Camera camera(40);
  Watch watch;
  camera.see();
  CHECK(watch.compare(camera));
  CHECK(watch.picture.starting());
  CHECK(watch.count(Look::kNothing, true) == kInside);
  watch.learn(camera, 20);
  CHECK_FALSE(watch.picture.starting());
  CHECK(watch.count(Look::kSame, false) >= kOutside - 2);
  watch.picture.forget();
  camera.see();
  watch.compare(camera);
  CHECK(watch.count(Look::kNothing, false) == kOutside);
  watch.learn(camera, 20);
  CHECK(watch.count(Look::kSame, false) >= kOutside - 2);
  CHECK_FALSE(watch.picture.looks_as_ever(2, 10));  // the look was learnt after a motion
  CHECK_FALSE(watch.picture.compare(camera.luma, camera.color, 60, 40, watch.all));
  CHECK_FALSE(watch.picture.compare(camera.luma, {}, kWidth, kHeight, watch.all));
}

TEST_CASE("after the first frame the picture takes no memory, nor when it is sure",
          "[map][static_picture]") {
  Camera camera(50);
  Watch watch;
  for (int k = 0; k < 60; ++k) {
    const bool changed = k >= 50;
    camera.see([&](int x, int y, auto& light) {
      if (changed && Watch::in_thing(x, y)) light = {60, 140, 60};
    });
    const int taken = test::allocations_during([&] {
      watch.compare(camera);
      watch.picture.learn(watch.none, watch.all);
    });
    if (k > 0) CHECK(taken == 0);
    // A known tile is recognised as changed.
    if (changed) CHECK(watch.count(Look::kChanged, true) == kInside);
  }
}

}  // namespace
}  // namespace palpable

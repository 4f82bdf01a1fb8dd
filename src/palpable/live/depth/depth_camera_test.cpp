#include "palpable/live/depth/depth_camera.h"

#include "tests/support/allocations.h"
#include "tests/support/test.h"
#include "tests/support/tilted_pair.h"

#include <opencv2/core/utility.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace palpable {
namespace {

constexpr int kWidth = 320;
constexpr int kHeight = 180;
const float kNaN = std::nanf("");

// A quarter of a 720p rig: f = 175 px, T = 63 mm, so 0.14 m has 79 px of disparity.
RectifiedStereo small_stereo(double doffs_px = 0) {
  return {{kWidth, kHeight, 175, 175, 159.5, 89.5}, 0.063, -doffs_px};
}

// Smooth random brightness as a function of a plane's coordinates, in units of about a pixel: four
// octaves of value noise, the finest 2 px wide, so that it can be matched and interpolated.
class Texture {
 public:
  explicit Texture(unsigned seed) {
    auto random = test::random_case(seed);
    for (double& v : lattice_) v = std::uniform_real_distribution<double>(-1, 1)(random);
  }
  [[nodiscard]] double operator()(double u, double v) const {
    double sum = 128;
    double amplitude = 60;
    for (double width = 16; width >= 2; width /= 2) {
      sum += amplitude * noise(u / width, v / width);
      amplitude *= 0.7;
    }
    return std::clamp(sum, 0.0, 255.0);
  }

 private:
  [[nodiscard]] double at(int i, int j) const { return lattice_[(i & 127) + 128 * (j & 127)]; }
  [[nodiscard]] double noise(double u, double v) const {
    const int i = static_cast<int>(std::floor(u));
    const int j = static_cast<int>(std::floor(v));
    const auto ease = [](double t) { return t * t * (3 - 2 * t); };
    const double s = ease(u - i);
    const double t = ease(v - j);
    return (1 - t) * ((1 - s) * at(i, j) + s * at(i + 1, j)) +
           t * ((1 - s) * at(i, j + 1) + s * at(i + 1, j + 1));
  }
  std::array<double, 128 * 128> lattice_{};
};

// A plane that both eyes see; its brightness is fixed to the plane.
struct Plane {
  double depth;    // m, where the left eye's axis meets it
  double slope_x;  // dZ/dX
  double slope_y;

  // Z of the point seen at (u, v) by an eye that stands at X = eye.
  [[nodiscard]] double Z(const PinholeCamera& c, double u, double v, double eye) const {
    // Z = depth + sx X + sy Y with X = eye + Z a, Y = Z b
    const double a = (u - c.cx_px) / c.fx_px;
    const double b = (v - c.cy_px) / c.fy_px;
    return (depth + slope_x * eye) / (1 - slope_x * a - slope_y * b);
  }
};

Frame frame_of(const Plane& plane, const RectifiedStereo& stereo, unsigned seed) {
  static const Texture texture(7);
  auto random = test::random_case(seed);
  std::normal_distribution<double> noise(0, 0.7);  // grey levels, as a ZED Mini has
  Frame frame;
  frame.left = ColorImage(stereo.camera.width, stereo.camera.height);
  frame.right = frame.left;
  for (const bool is_left : {true, false}) {
    const PinholeCamera& c = stereo.camera;
    const double eye = is_left ? 0.0 : stereo.baseline;
    ColorImage& image = is_left ? frame.left : frame.right;
    for (int y = 0; y < c.height; ++y) {
      for (int x = 0; x < c.width; ++x) {
        // d = f T / Z + d_inf: the right picture is shifted by -d_inf.
        const double u = is_left ? x : x + stereo.disparity_at_infinity_px;
        const double Z = plane.Z(c, u, y, eye);
        const double X = eye + (u - c.cx_px) / c.fx_px * Z;
        const double Y = (y - c.cy_px) / c.fy_px * Z;
        const double px = c.fx_px / plane.depth;  // plane coordinates in pixels
        const double level =
            std::clamp(texture(X * px + 300, Y * px + 300) + noise(random), 0.0, 255.0);
        const auto byte = static_cast<std::uint8_t>(std::lround(level));
        image(x, y) = {byte, byte, byte};
      }
    }
  }
  return frame;
}

FrameFormat format_of(const RectifiedStereo& stereo) {
  FrameFormat format;
  format.width = stereo.camera.width;
  format.height = stereo.camera.height;
  format.already_rectified = true;
  format.rectified = stereo;
  return format;
}

struct Quality {
  double known = 0;     // share of the pixels that both eyes see
  double median = 0;    // of |error| / Z
  double within_1 = 0;  // share of the known ones within 1 %
  double within_5 = 0;
};

Quality quality_of(const SeenFrame& seen, const Plane& plane, const RectifiedStereo& stereo) {
  std::vector<double> errors;
  int both = 0;
  const PinholeCamera& c = seen.depth_camera;
  const double scale = stereo.camera.fx_px / c.fx_px;
  for (int y = 0; y < c.height; ++y) {
    for (int x = 0; x < c.width; ++x) {
      const double Z = plane.Z(c, x, y, 0);
      if (x * scale - stereo.disparity_px(Z) < 1) continue;
      ++both;
      const float measured = seen.depth(x, y);
      if (!std::isnan(measured)) errors.push_back(std::abs(measured - Z) / Z);
    }
  }
  std::sort(errors.begin(), errors.end());
  const auto share_below = [&](double limit) {
    const auto end = std::lower_bound(errors.begin(), errors.end(), limit);
    return static_cast<double>(end - errors.begin()) / static_cast<double>(errors.size());
  };
  if (errors.empty()) return {};
  return {static_cast<double>(errors.size()) / both, errors[errors.size() / 2], share_below(0.01),
          share_below(0.05)};
}

TEST_CASE("a slanted, textured plane comes out at its depth", "[depth][Sec3.3]") {
  const RectifiedStereo stereo = small_stereo();
  for (const bool full : {false, true}) {
    auto camera = value_or_throw(DepthCamera::make(format_of(stereo), {.full_resolution = full}));
    for (const Plane& plane :
         {Plane{0.30, 0.3, -0.4}, Plane{0.5, -0.5, 0.2}, Plane{0.2, 0.1, 0.1}}) {
      INFO((full ? "full" : "half") << " resolution, plane at " << plane.depth);
      SeenFrame seen;
      camera.see(frame_of(plane, stereo, 1), seen);
      REQUIRE(seen.depth.width() == (full ? kWidth : kWidth / 2));
      REQUIRE(seen.depth.height() == (full ? kHeight : kHeight / 2));
      CHECK(seen.depth_camera == (full ? stereo.camera : stereo.camera.scaled_down(2)));
      const Quality quality = quality_of(seen, plane, stereo);
      INFO("known " << quality.known << ", median " << quality.median << ", within 5 % "
                    << quality.within_5);
      CHECK(quality.known >= 0.9);
      // A tenth of a pixel: at half resolution d = f T / Z = 5.5 / Z px.
      const double tenth = 0.1 * plane.depth / (stereo.camera.fx_px * 0.063) * (full ? 1 : 2);
      CHECK(quality.median <=
            test::tolerance(2 * tenth, "block matching locks to whole pixels: up to 0.2 px"));
      CHECK(quality.within_5 >= 0.97);
    }
  }
}

TEST_CASE("walls at 5, 10 and 15 m come out better than the paper's camera", "[depth][Sec3.3]") {
  // A ZED Mini at 720p; 1 % of 15 m is 0.03 px.
  const RectifiedStereo stereo{{1280, 720, 700, 700, 639.5, 359.5}, 0.063, 0};
  auto camera = value_or_throw(DepthCamera::make(format_of(stereo), {.farthest = 40}));
  for (const double Z : {5.0, 10.0, 15.0}) {
    const Plane wall{Z, 0.1, 0};
    SeenFrame seen;
    camera.see(frame_of(wall, stereo, 4), seen);
    const Quality quality = quality_of(seen, wall, stereo);
    INFO("wall at " << Z << " m: known " << quality.known << ", median " << quality.median
                    << ", within 1 % " << quality.within_1 << ", within 5 % " << quality.within_5);
    CHECK(quality.known >= 0.9);
    // The paper's camera: 1 % near to 9 % at 15 m.
    const double twentieth = 0.05 * Z / (stereo.camera.fx_px * stereo.baseline);
    CHECK(quality.median <= test::tolerance(twentieth, "a twentieth of a pixel: 1.7 % at 15 m"));
  }
}

TEST_CASE("a wide rig sees beyond 20 m by itself, a narrow one does not", "[depth]") {
  const Plane wall{25, 0.1, 0};
  for (const double baseline : {0.063, 0.54}) {
    const RectifiedStereo stereo{{640, 360, 700, 700, 319.5, 179.5}, baseline, 0};
    auto camera = value_or_throw(DepthCamera::make(format_of(stereo)));
    SeenFrame seen;
    camera.see(frame_of(wall, stereo, 4), seen);
    const Quality quality = quality_of(seen, wall, stereo);
    INFO("baseline " << baseline << " m: known " << quality.known);
    CHECK((quality.known > 0.8) == (baseline > 0.5));
    CHECK((quality.known < 0.2) == (baseline < 0.5));
  }
}

TEST_CASE(
    "OpenCV's matcher, the reference, finds the same plane; it does not say what is too close",
    "[depth][Sec3.3]") {
  const Plane plane{0.4, 0.2, 0.1};
  for (const double doffs : {0.0, 12.0}) {
    const RectifiedStereo stereo = small_stereo(doffs);
    auto camera = value_or_throw(DepthCamera::make(
        format_of(stereo), {.matcher = DepthSettings::Matcher::kOpenCv, .full_resolution = true}));
    const Frame frame = frame_of(plane, stereo, 2);
    SeenFrame seen;
    camera.see(frame, seen);
    const Quality quality = quality_of(seen, plane, stereo);
    INFO("doffs " << doffs << ": known " << quality.known << ", median " << quality.median);
    CHECK(quality.known >= 0.75);
    CHECK(quality.median <= test::tolerance(0.01, "a quarter of a pixel of 28"));
    REQUIRE(camera.rectified() != nullptr);
    CHECK(camera.rectified()->disparity_at_infinity_px == -doffs);
    CHECK((seen.too_close.empty() && seen.confidence.empty()));
    CHECK(std::isnan(seen.row_error_px));
    Frame bad = frame;
    bad.right = ColorImage(kWidth, kHeight - 1);
    camera.see(bad, seen);
    CHECK(camera.last_times().stages().empty());
    CHECK(std::all_of(seen.depth.begin(), seen.depth.end(), [](float Z) { return std::isnan(Z); }));
  }
}

TEST_CASE("a disparity at infinity that is not zero is taken off", "[depth][Sec3.3]") {
  const Plane plane{0.4, 0.2, 0.1};
  for (const double doffs : {12.0, -8.0}) {
    const RectifiedStereo stereo = small_stereo(doffs);
    auto camera = value_or_throw(DepthCamera::make(format_of(stereo)));
    SeenFrame seen;
    camera.see(frame_of(plane, stereo, 2), seen);
    const Quality quality = quality_of(seen, plane, stereo);
    INFO("doffs " << doffs << ": known " << quality.known << ", median " << quality.median);
    CHECK(quality.known >= 0.9);
    CHECK(quality.median <= test::tolerance(0.015, "0.2 px of 14 at half resolution"));
  }
}

TEST_CASE("a raw rig gives the depth of its rectified frame", "[depth][Sec3.3]") {
  // The rig has no distortion or rotation, but its focal length differs from that of the rectified
  // picture, which all computations must use.
  StereoRig rig;
  rig.left.pinhole = rig.right.pinhole = small_stereo().camera;
  rig.right_from_left.translation().x() = -0.063;
  FrameFormat format;
  format.width = kWidth;
  format.height = kHeight;
  format.rig = rig;
  auto camera = value_or_throw(DepthCamera::make(format));
  const Plane plane{0.3, 0.1, -0.2};
  SeenFrame seen;
  camera.see(frame_of(plane, small_stereo(), 3), seen);
  RectifiedStereo rectified = small_stereo();
  rectified.camera = camera.camera();
  const Quality quality = quality_of(seen, plane, rectified);
  INFO("known " << quality.known << ", median " << quality.median);
  CHECK(quality.known >= 0.9);
  CHECK(quality.median <= test::tolerance(0.011, "0.2 px of 18 at half resolution"));
  CHECK(seen.color.width() == kWidth);
  CHECK(seen.camera == camera.camera());
}

TEST_CASE("a frame as a camera sent it gives the depth of its colours", "[depth]") {
  const RectifiedStereo stereo = small_stereo();
  const Plane plane{0.5, 0.2, -0.1};
  const Frame colors = frame_of(plane, stereo, 1);
  Frame sent;
  sent.both.resize(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < 2 * kWidth; x += 2) {
      const ColorImage& eye = x < kWidth ? colors.left : colors.right;
      const auto luma = [&](int at) {  // gray levels
        return static_cast<std::uint8_t>(std::lround(16 + eye(at % kWidth, y).g * 219 / 255.0));
      };
      sent.both(x / 2, y) = {luma(x), 128, luma(x + 1), 128};
    }
  }
  DepthCamera camera = value_or_throw(DepthCamera::make(format_of(stereo)));
  SeenFrame seen;
  camera.see(sent, seen);
  const Quality found = quality_of(seen, plane, stereo);
  camera.see(colors, seen);
  const Quality wanted = quality_of(seen, plane, stereo);
  CHECK(wanted.known > 0.9);
  CHECK(std::abs(found.known - wanted.known) <= test::tolerance(0.01, "luma of 219 steps"));
  CHECK(std::abs(found.median - wanted.median) <= test::tolerance(5e-4, "the same"));

  sent.both.resize(kWidth - 2, kHeight);
  camera.see(sent, seen);
  CHECK(std::all_of(seen.depth.begin(), seen.depth.end(), [](float Z) { return std::isnan(Z); }));
}

TEST_CASE("what the right eye cannot see has no depth", "[depth]") {
  const RectifiedStereo stereo = small_stereo();
  const Plane plane{0.25, 0, 0};  // 44 px of disparity, 22 at half resolution
  auto camera = value_or_throw(DepthCamera::make(format_of(stereo)));
  SeenFrame seen;
  camera.see(frame_of(plane, stereo, 9), seen);
  int guessed = 0;
  for (int y = 0; y < seen.depth.height(); ++y) {
    for (int x = 0; x < 21; ++x) {
      // A pixel of the plane whose partner is outside the right image.
      if (std::abs(seen.depth(x, y) - 0.25F) < 0.01F) ++guessed;
    }
  }
  CHECK(guessed == 0);
}

TEST_CASE("where there is nothing to match, the depth is unknown", "[depth]") {
  auto camera = value_or_throw(DepthCamera::make(format_of(small_stereo())));
  Frame frame;
  frame.left = frame.right = ColorImage(kWidth, kHeight, Rgb{90, 90, 90});
  SeenFrame seen;
  camera.see(frame, seen);
  const auto known =
      std::count_if(seen.depth.begin(), seen.depth.end(), [](float Z) { return !std::isnan(Z); });
  CHECK(known == 0);
}

TEST_CASE("two eyes that see different things agree on little", "[depth]") {
  auto camera = value_or_throw(DepthCamera::make(format_of(small_stereo())));
  auto random = test::random_case(4);
  Frame frame;
  frame.left = frame.right = ColorImage(kWidth, kHeight);
  for (ColorImage* image : {&frame.left, &frame.right}) {
    for (Rgb& pixel : *image) {
      const auto level = static_cast<std::uint8_t>(random() % 256);
      pixel = {level, level, level};
    }
  }
  SeenFrame seen;
  camera.see(frame, seen);
  const auto known =
      std::count_if(seen.depth.begin(), seen.depth.end(), [](float Z) { return !std::isnan(Z); });
  // Only chance agreements pass the left-right check and the speckle filter.
  CHECK(static_cast<double>(known) <= 0.3 * static_cast<double>(seen.depth.size()));
}

TEST_CASE("depths are positive and no farther than asked, or unknown", "[depth][law]") {
  const RectifiedStereo stereo = small_stereo(5);
  auto camera =
      value_or_throw(DepthCamera::make(format_of(stereo), {.nearest = 0.2, .farthest = 0.45}));
  SeenFrame seen;
  // The plane extends beyond both ends of the range.
  camera.see(frame_of({0.3, 0.9, 0.0}, stereo, 5), seen);
  int known = 0;
  for (const float Z : seen.depth) {
    if (std::isnan(Z)) continue;
    ++known;
    CHECK((Z > 0.1F && Z <= 0.45F));
  }
  CHECK(known > 1000);
}

TEST_CASE("colour and depth pass through, what is not a depth as unknown", "[depth]") {
  FrameFormat format;
  format.kind = FrameFormat::Kind::kColorDepth;
  format.width = 5;
  format.height = 3;
  format.depth_camera = {5, 3, 6, 7, 2, 1};
  auto camera = value_or_throw(DepthCamera::make(format));
  Frame frame;
  frame.number = 12;
  frame.time = 0.4;
  frame.left = ColorImage(5, 3, Rgb{1, 2, 3});
  frame.depth = DepthImage(5, 3, 0.7F);
  frame.depth(1, 0) = kNaN;
  frame.depth(2, 0) = 0;
  frame.depth(3, 0) = -1;
  frame.depth(4, 0) = 1e9F;
  SeenFrame seen;
  camera.see(frame, seen);
  CHECK(seen.number == 12);
  CHECK(seen.time == 0.4);
  CHECK(seen.color == frame.left);
  CHECK(seen.camera == format.depth_camera);
  CHECK(seen.depth_camera == format.depth_camera);
  CHECK(seen.depth(0, 0) == 0.7F);
  for (int x = 1; x < 5; ++x) CHECK(std::isnan(seen.depth(x, 0)));
  CHECK(seen.depth(4, 2) == 0.7F);
  CHECK(camera.rectified() == nullptr);  // there is no second eye
}

TEST_CASE("depth of a sensor beside the colour's comes out in the colour's view",
          "[depth][registration]") {
  FrameFormat format;
  format.kind = FrameFormat::Kind::kColorDepth;
  format.depth_camera = {0, 0, 110, 110, 31.5, 19.5};
  format.color_sensor = ColorSensor{{0, 0, 100, 100, 31.5, 19.5}, Rigid3::Identity()};
  format.color_sensor->color_from_depth.translation() << -0.025, 0, 0.1;
  set_size(format, 64, 40);
  auto camera = value_or_throw(DepthCamera::make(format));
  CHECK(camera.camera() == format.color_sensor->camera);
  CHECK(camera.depth_camera() == format.color_sensor->camera);
  Frame frame;
  frame.left = ColorImage(64, 40, Rgb{9, 8, 7});
  frame.left(5, 6) = Rgb{200, 0, 0};
  frame.depth = DepthImage(64, 40, 0.9F);
  frame.depth(31, 19) = 50.0F;  // beyond the farthest
  SeenFrame seen;
  camera.see(frame, seen);
  CHECK(seen.color == frame.left);
  CHECK(seen.camera == format.color_sensor->camera);
  // A depth of 0.9 m from the depth camera is 1 m from the colour camera.
  CHECK(seen.depth(20, 10) == Approx(1.0).epsilon(1e-6));
  // The unknown pixel is -0.5 / 110 x 0.9 m from the axis, and 25 mm to the left of it at 1 m, with
  // f = 100 px.
  CHECK(std::isnan(seen.depth(29, 19)));
  CHECK(seen.depth(32, 19) == Approx(1.0).epsilon(1e-6));
  CHECK(test::allocations_during([&] { camera.see(frame, seen); }) == 0);

  format.color_sensor->camera.width = 63;
  CHECK_FALSE(DepthCamera::make(format).ok());
  set_size(format, 64, 40);
  format.color_sensor->camera.fy_px = 0;
  CHECK_FALSE(DepthCamera::make(format).ok());
}

TEST_CASE("a frame of another size has no depth, and the next one is as good as ever",
          "[depth][refusal]") {
  const RectifiedStereo stereo = small_stereo();
  auto camera = value_or_throw(DepthCamera::make(format_of(stereo)));
  const Frame good = frame_of({0.3, 0.1, 0.1}, stereo, 6);
  SeenFrame first;
  camera.see(good, first);
  REQUIRE(first.left_half.width() == kWidth / 2);
  REQUIRE(first.left_half.height() == kHeight / 2);
  for (int y = 0; y < kHeight / 2; ++y) {
    for (int x = 0; x < kWidth / 2; ++x) {
      const int sum = first.left(2 * x, 2 * y) + first.left(2 * x + 1, 2 * y) +
                      first.left(2 * x, 2 * y + 1) + first.left(2 * x + 1, 2 * y + 1);
      REQUIRE(first.left_half(x, y) == (sum + 2) / 4);
    }
  }
  for (const auto& [width, height] : {std::pair{0, 0}, std::pair{kWidth, kHeight - 1}}) {
    Frame bad = good;
    bad.right = ColorImage(width, height);
    SeenFrame seen = first;  // its content must be replaced
    camera.see(bad, seen);
    CHECK((seen.left.empty() && seen.left_half.empty() && seen.right.empty()));
    REQUIRE(seen.depth.width() == kWidth / 2);
    CHECK(std::all_of(seen.depth.begin(), seen.depth.end(), [](float Z) { return std::isnan(Z); }));
  }
  SeenFrame again;
  camera.see(good, again);
  const auto same = [](float a, float b) { return a == b || (std::isnan(a) && std::isnan(b)); };
  CHECK(std::equal(first.depth.begin(), first.depth.end(), again.depth.begin(), same));
}

TEST_CASE("depth is the same to the bit on one and on two threads", "[depth]") {
  const RectifiedStereo stereo = small_stereo();
  const Frame frame = frame_of({0.3, 0.3, -0.2}, stereo, 7);
  const auto depth_with = [&](int threads) {
    cv::setNumThreads(threads);
    auto camera = value_or_throw(DepthCamera::make(format_of(stereo)));
    SeenFrame seen;
    camera.see(frame, seen);
    for (float& Z : seen.depth) {
      if (std::isnan(Z)) Z = 0;
    }
    return seen.depth;
  };
  const DepthImage one = depth_with(1);
  const DepthImage two = depth_with(2);
  cv::setNumThreads(-1);  // the default again
  CHECK(one == two);
}

TEST_CASE("after the first frame, seeing takes no memory of ours, and says where its time went",
          "[depth]") {
  const RectifiedStereo stereo = small_stereo();
  StereoRig rig;
  rig.left.pinhole = rig.right.pinhole = stereo.camera;
  rig.left.distortion = {-0.17, 0.03, 0, 0, 0};
  rig.right_from_left.translation().x() = -0.063;
  FrameFormat format = format_of(stereo);
  format.already_rectified = false;
  format.rig = rig;
  auto camera = value_or_throw(DepthCamera::make(format));
  const Frame frame = frame_of({0.3, 0.3, -0.2}, stereo, 8);
  SeenFrame seen;
  camera.see(frame, seen);
  CHECK(test::allocations_during([&] { camera.see(frame, seen); }) == 0);
  REQUIRE(camera.last_times().stages().size() == 3);
  for (const char* stage : {"rectify", "disparity", "depth"}) {
    CHECK(camera.last_times().ms(stage) > 0);
  }
}

TEST_CASE("a first frame whose rows are far off, or whose eyes are swapped, says so",
          "[depth][refusal]") {
  const RectifiedStereo stereo = small_stereo();
  const Frame fits = frame_of({0.3, 0.1, -0.2}, stereo, 21);
  Frame lower = fits;  // the right image by 12 px
  for (int y = kHeight - 1; y >= 0; --y) {
    std::copy_n(fits.right.row(std::max(y - 12, 0)), kWidth, lower.right.row(y));
  }
  Frame swapped = fits;
  std::swap(swapped.left, swapped.right);
  for (const bool full : {false, true}) {
    const DepthSettings settings{.full_resolution = full};
    const auto misfit = [&](const Frame& frame) {
      auto camera = value_or_throw(DepthCamera::make(format_of(stereo), settings));
      SeenFrame seen;
      camera.see(frame, seen);
      const auto first = seen.misfit;
      camera.see(frame, seen);
      CHECK_FALSE(seen.misfit);  // reported only in the first frame
      return first;
    };
    INFO((full ? "full" : "half") << " resolution");
    CHECK_FALSE(misfit(fits));
    const auto rows = misfit(lower);
    REQUIRE(rows);
    CHECK_FALSE(rows->swapped);
    CHECK(std::abs(rows->rows_px - 12) <= 1);
    const auto eyes = misfit(swapped);
    REQUIRE(eyes);
    CHECK(eyes->swapped);
  }
}

ColorImage gray_color(const GrayImage& gray) {
  ColorImage color(gray.width(), gray.height());
  std::transform(gray.begin(), gray.end(), color.begin(), [](std::uint8_t level) {
    return Rgb{level, level, level};
  });
  return color;
}

TEST_CASE("a camera whose eyes are turned is right again within a second", "[depth][rows]") {
  const FrameFormat format = format_of(test::tilted_stereo());
  auto camera = value_or_throw(DepthCamera::make(format));
  const auto pair = test::tilted_pair({0.15 * kDegree, 0.05 * kDegree}, 4);  // 0.9 px
  Frame frame;
  frame.left = gray_color(pair.left);
  frame.right = gray_color(pair.right);
  SeenFrame seen;
  double first = 0;
  for (int i = 0; i < 30; ++i) {
    camera.see(frame, seen);
    if (i == 0) first = seen.row_error_px;
  }
  CHECK(std::abs(first - 0.92) <= test::tolerance(0.15, "px; the median of a rolled picture"));
  CHECK(std::abs(seen.row_error_px) <= test::tolerance(0.06, "px; the watch's limit"));
  CHECK(std::abs(seen.row_correction_px - 0.92) <= test::tolerance(0.1, "px"));

  DepthSettings settings;
  settings.watch_rows = false;
  auto blind = value_or_throw(DepthCamera::make(format, settings));
  for (int i = 0; i < 20; ++i) blind.see(frame, seen);
  CHECK(std::isnan(seen.row_error_px));
  CHECK(seen.row_correction_px == 0);
}

TEST_CASE("rows that are too far off to be matched are found again, however far away all is",
          "[depth][rows]") {
  // The wall is at 55 m for this rig, 0.4 px from infinity and beyond its limit of 20 m.
  RectifiedStereo stereo = test::tilted_stereo();
  stereo.disparity_at_infinity_px = test::kTiltedDisparity - 0.4;
  const FrameFormat format = format_of(stereo);
  for (const double rows : {2.5, -2.5}) {
    INFO(rows << " px out of line");
    auto camera = value_or_throw(DepthCamera::make(format, {.farthest = 1000}));
    auto usual = value_or_throw(DepthCamera::make(format));
    const auto pair = test::tilted_pair({rows / stereo.camera.fy_px, 0}, 4);
    Frame frame;
    frame.left = gray_color(pair.left);
    frame.right = gray_color(pair.right);
    SeenFrame seen, beyond;
    double first = 0;
    for (int i = 0; i < 40; ++i) {
      camera.see(frame, seen);
      usual.see(frame, beyond);
      if (i == 0) first = seen.density;
    }
    INFO("density " << first << " at first, then " << seen.density);
    CHECK(std::abs(seen.row_correction_px - rows) <= test::tolerance(0.1, "px"));
    CHECK(std::abs(beyond.row_correction_px - rows) <= test::tolerance(0.1, "px"));
    CHECK(std::abs(seen.row_error_px) <= test::tolerance(0.06, "px; the watch's limit"));
    CHECK(first < 0.5);
    CHECK(seen.density > 0.9);
    CHECK(seen.trouble == DepthTrouble::kNone);
    // Beyond 20 m nothing has a depth, which is reported, but the rows are aligned.
    CHECK(beyond.density < 0.05);
    CHECK(beyond.trouble == DepthTrouble::kFewDepths);
  }
}

TEST_CASE("small images are matched at full size where that is asked for, large ones at half",
          "[depth]") {
  const FrameFormat format = format_of(test::tilted_stereo());
  const auto width = [&](int up_to) {
    const auto camera = value_or_throw(DepthCamera::make(format, {.full_up_to_px = up_to}));
    return camera.depth_camera().width;
  };
  CHECK(width(0) == test::kTiltedWidth / 2);
  CHECK(width(test::kTiltedWidth - 1) == test::kTiltedWidth / 2);
  CHECK(width(test::kTiltedWidth) == test::kTiltedWidth);
}

TEST_CASE("numbers that do not make a camera are refused with a reason", "[depth][refusal]") {
  const auto reason = [](const FrameFormat& format, const DepthSettings& settings = {}) {
    const auto camera = DepthCamera::make(format, settings);
    REQUIRE_FALSE(camera.ok());
    return camera.problem().message;
  };
  const auto contains = [](const std::string& text, const char* part) {
    INFO(text);
    return text.find(part) != std::string::npos;
  };
  FrameFormat format = format_of(small_stereo());
  CHECK(contains(reason(format, {.nearest = 0}), "0 m"));
  CHECK(contains(reason(format, {.nearest = 2, .farthest = 1}), "larger"));
  format.width = 640;
  CHECK(contains(reason(format), "640 x 180"));
  format = format_of(small_stereo());
  format.rectified.baseline = 63;
  CHECK(contains(reason(format), "metres"));
  format = format_of(small_stereo());
  format.already_rectified = false;  // and there is no rig
  CHECK_FALSE(DepthCamera::make(format).ok());
  format = format_of({{20, 10, 15, 15, 10, 5}, 0.063, 0});
  CHECK(contains(reason(format), "too small"));
  FrameFormat depth;
  depth.kind = FrameFormat::Kind::kColorDepth;
  CHECK(contains(reason(depth), "the depth image is 0 x 0 px"));
  depth.depth_camera = {0, 0, 30, 31, 30, 20};
  set_size(depth, 64, 40);
  CHECK(DepthCamera::make(depth).ok());
  depth.depth_camera.cx_px = 64.5;
  CHECK(contains(reason(depth), "principal point"));
}

}  // namespace
}  // namespace palpable

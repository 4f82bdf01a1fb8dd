#include "palpable/live/calibrate/yuyv_kernels.h"

#include "palpable/live/calibrate/rectification.h"
#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <vector>

namespace palpable {
namespace {

using Eye = Rectification::Eye;

YuyvImage noise(int pairs, int height, unsigned seed) {
  auto random = test::random_case(seed);
  std::uniform_int_distribution<int> byte(0, 255);
  const auto next = [&] { return static_cast<std::uint8_t>(byte(random)); };
  YuyvImage image(pairs, height);
  for (Yuyv& pair : image) pair = {next(), next(), next(), next()};
  return image;
}

// A grid that rotates and stretches, and extends beyond the raw picture on all sides.
WarpGrid some_grid(int width, int height, const YuyvEye& eye) {
  WarpGrid grid;
  grid.resize(width, height);
  for (int v = 0; v < height; ++v) {
    for (int i = 0; i < grid.columns; ++i) {
      const double u = i * WarpGrid::kStep;
      const double x = u / width * (eye.width + 9) - 4.3 + 0.11 * v + 3 * std::sin(u / 40);
      const double y = 1.0 * v / height * (eye.height + 7) - 3.1 + 0.04 * u;
      grid.set(v, i * WarpGrid::kStep, x, y);
    }
  }
  grid.prepare(eye.width, eye.height);
  return grid;
}

TEST_CASE("all instruction sets warp to the same bytes", "[calibrate][yuyv]") {
  // Neither the width nor its half is a multiple of any vector's.
  for (const int width : {4, 16, 38, 122}) {
    INFO("width " << width);
    const YuyvImage both = noise(70, 37, 3);
    const YuyvEye eye{both.row(0) + 9, 70, 98, 37};
    const WarpGrid grid = some_grid(width, 29, eye);
    GrayImage luma(width, 29), luma_here(width, 29);
    ColorImage color(width, 29), color_here(width, 29);
    const YuyvKernels& plain = yuyv_kernels().back();
    plain.luma(grid, eye, luma);
    plain.color(grid, eye, luma, color);
    for (const YuyvKernels& kernels : yuyv_kernels()) {
      INFO(kernels.name);
      kernels.luma(grid, eye, luma_here);
      kernels.color(grid, eye, luma, color_here);
      CHECK(luma_here == luma);
      CHECK(color_here == color);
    }
  }
}

TEST_CASE("where nothing is warped, luma is that of the pixels, up to the borders",
          "[calibrate][yuyv]") {
  Rectification rectification(RectifiedStereo{{22, 9, 100, 100, 10, 4}, 0.1, 0});
  const YuyvImage both = noise(22, 9, 5);
  for (const Eye eye : {Eye::kLeft, Eye::kRight}) {
    GrayImage luma;
    rectification.rectify_luma(eye, both, luma);
    for (int y = 0; y < 9; ++y) {
      for (int x = 0; x < 22; ++x) {
        const Yuyv pair = both((eye == Eye::kLeft ? 0 : 11) + x / 2, y);
        const double Y = x % 2 == 0 ? pair.y0 : pair.y1;
        const double wanted = std::clamp((Y - 16) * 255 / 219, 0.0, 255.0);
        INFO(x << " " << y);
        CHECK(std::abs(luma(x, y) - wanted) <=
              test::tolerance(0.6, "rounding, and 1192 / 1024 for 255 / 219"));
      }
    }
  }
}

// Converts colours to YUYV as bench/live and most cameras do.
YuyvImage yuyv_of(const ColorImage& left, const ColorImage& right) {
  YuyvImage both(left.width(), left.height());
  const auto byte = [](double x) {
    return static_cast<std::uint8_t>(std::clamp(std::lround(x), 0L, 255L));
  };
  for (int y = 0; y < left.height(); ++y) {
    for (int x = 0; x < 2 * left.width(); x += 2) {
      const ColorImage& eye = x < left.width() ? left : right;
      const Rgb a = eye(x % left.width(), y), b = eye(x % left.width() + 1, y);
      const auto Y = [](Rgb c) { return 16 + 0.257 * c.r + 0.504 * c.g + 0.098 * c.b; };
      const auto U = [](Rgb c) { return -0.148 * c.r - 0.291 * c.g + 0.439 * c.b; };
      const auto V = [](Rgb c) { return 0.439 * c.r - 0.368 * c.g - 0.071 * c.b; };
      both(x / 2, y) = {byte(Y(a)), byte(128 + (U(a) + U(b)) / 2), byte(Y(b)),
                        byte(128 + (V(a) + V(b)) / 2)};
    }
  }
  return both;
}

StereoRig some_rig() {
  StereoRig rig;
  rig.left = {{320, 180, 175.0, 175.4, 162.6, 90.2}, {-0.174, 0.0278, -3e-4, -2e-4, 1e-3}};
  rig.right = {{320, 180, 174.6, 174.9, 157.7, 87.6}, {-0.176, 0.0291, 2e-4, 1.9e-4, 0}};
  rig.right_from_left.translation() << -0.063, 0.0012, -0.0008;
  return rig;
}

ColorImage smooth_picture(double phase) {
  ColorImage image(320, 180);
  for (int y = 0; y < 180; ++y) {
    for (int x = 0; x < 320; ++x) {
      const auto wave = [&](double length, double turn) {
        return static_cast<std::uint8_t>(
            std::lround(128 + 50 * std::sin((x + turn * y) / length + phase)));
      };
      image(x, y) = {wave(19, 0.3), wave(13, -0.7), wave(29, 1.1)};
    }
  }
  return image;
}

TEST_CASE("a picture as it was sent rectifies to what its colours rectify to",
          "[calibrate][yuyv][Sec3.3]") {
  Rectification rectification(some_rig());
  const ColorImage left = smooth_picture(0), right = smooth_picture(1);
  const YuyvImage both = yuyv_of(left, right);
  GrayImage luma_left, luma_right, wanted;
  ColorImage color, wanted_color;
  rectification.rectify_luma(Eye::kLeft, both, luma_left);
  rectification.rectify_luma(Eye::kRight, both, luma_right);
  rectification.rectify_left(both, luma_left, color);
  rectification.rectify(Eye::kLeft, left, wanted_color);
  const auto worst_and_mean = [](const GrayImage& a, const GrayImage& b) {
    int worst = 0;
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      const int off = std::abs(a.data()[i] - b.data()[i]);
      worst = std::max(worst, off);
      sum += off;
    }
    return std::pair{worst, sum / static_cast<double>(a.size())};
  };
  for (const Eye eye : {Eye::kLeft, Eye::kRight}) {
    INFO((eye == Eye::kLeft ? "left" : "right"));
    rectification.rectify_luma(eye, eye == Eye::kLeft ? left : right, wanted);
    const auto [worst, mean] = worst_and_mean(eye == Eye::kLeft ? luma_left : luma_right, wanted);
    CHECK(worst <= test::tolerance(3, "luma of 219 steps, 1/32 px of up to 5 levels, roundings"));
    CHECK(mean <= test::tolerance(0.7, "the same; half a pixel off gives 2"));
  }
  int worst = 0;
  for (std::size_t i = 0; i < color.size(); ++i) {
    const Rgb a = color.data()[i], b = wanted_color.data()[i];
    worst = std::max({worst, std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)});
  }
  CHECK(worst <= test::tolerance(8,
                                 "colour of two pixels together and of the nearest row: slopes "
                                 "of 4 levels a pixel; two roundings times 2"));
}

TEST_CASE("a picture of both eyes has their size, and takes no memory again",
          "[calibrate][yuyv][refusal]") {
  Rectification rectification(some_rig());
  GrayImage luma;
  ColorImage color;
  CHECK_THROWS_AS(rectification.rectify_luma(Eye::kLeft, noise(318, 180, 1), luma),
                  ContractViolation);
  const YuyvImage both = noise(320, 180, 1);
  CHECK_THROWS_AS(rectification.rectify_left(both, GrayImage(3, 3), color), ContractViolation);
  const auto work = [&] {
    rectification.rectify_luma(Eye::kLeft, both, luma);
    rectification.rectify_left(both, luma, color);
  };
  work();
  CHECK(test::allocations_during(work) == 0);
}

}  // namespace
}  // namespace palpable

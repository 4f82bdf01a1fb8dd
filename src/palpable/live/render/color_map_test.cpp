#include "palpable/live/render/color_map.h"

#include "palpable/live/render/gl_context.h"
#include "palpable/live/render/gl_objects.h"
#include "palpable/live/render/glsl_as_cpp.h"
#include "palpable/live/render/shader_files.h"
#include "tests/support/test.h"

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

using namespace palpable;
using palpable::test::tolerance;

namespace palpable::glsl {
namespace {
#include "palpable/live/render/shaders/depth.glsl"
}  // namespace
}  // namespace palpable::glsl

namespace {

/// Relative luminance of an sRGB colour (IEC 61966-2-1).
double luminance(Rgb color) {
  const auto linear = [](std::uint8_t byte) {
    const double c = byte / 255.0;
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
  };
  return 0.2126 * linear(color.r) + 0.7152 * linear(color.g) + 0.0722 * linear(color.b);
}

/// The GPU's values of `expression`, a vec4 that depends on gl_FragCoord, for a row of pixels.
std::vector<float> on_gpu(const std::string& include, const std::string& expression, int width) {
  const std::string fragment =
      "#version 450 core\n#include \"" + include +
      "\"\nout vec4 c;\nvoid main() { float i = gl_FragCoord.x - 0.5; c = " + expression + "; }\n";
  std::vector<ShaderFile> files(render_shader_files().begin(), render_shader_files().end());
  files.push_back({"here.frag", fragment});
  const Result<GlProgram> program = GlProgram::make(files, "full_screen.vert", "here.frag");
  INFO((program.ok() ? std::string() : program.problem().message));
  REQUIRE(program.ok());
  const GlTexture target(GL_RGBA32F, width, 1);
  const std::array<const GlTexture*, 1> targets{&target};
  const GlFramebuffer framebuffer(targets, nullptr);
  framebuffer.bind();
  program.value().use();
  const FullScreenTriangle triangle;
  triangle.draw();
  std::vector<float> values(4 * width);
  framebuffer.read(0, 0, 0, width, 1, GL_RGBA, GL_FLOAT, values.data());
  return values;
}

}  // namespace

TEST_CASE("more stress is always lighter", "[render][Fig16]") {
  for (const ColorScale scale :
       {ColorScale::kBlueYellow, ColorScale::kViridis, ColorScale::kGray}) {
    double before = -1;
    for (int i = 0; i <= 128; ++i) {
      INFO("scale " << static_cast<int>(scale) << ", share " << i / 128.0);
      const double here = luminance(color_of_share(static_cast<float>(i) / 128.0f, scale));
      CHECK(here > before);
      before = here;
    }
  }
}

TEST_CASE("scales have the colours of their names", "[render]") {
  const auto at = [](float share, ColorScale scale) { return color_of_share(share, scale); };
  CHECK(at(0, ColorScale::kRainbow) == Rgb{0, 0, 128});
  CHECK(at(0.5f, ColorScale::kRainbow) == Rgb{128, 255, 128});
  CHECK(at(1, ColorScale::kRainbow) == Rgb{128, 0, 0});
  CHECK(at(1, ColorScale::kGray) == Rgb{255, 255, 255});
  // Ends and middle of viridis in matplotlib 3.6.
  const std::array<std::pair<float, Rgb>, 3> kViridis{
      {{0.0f, {68, 1, 84}}, {0.5f, {33, 145, 140}}, {1.0f, {253, 231, 37}}}};
  for (const auto& [share, wanted] : kViridis) {
    INFO("share " << share);
    const Rgb found = at(share, ColorScale::kViridis);
    CHECK(std::abs(found.r - wanted.r) <= tolerance(5, "of 255, the fit's 0.017"));
    CHECK(std::abs(found.g - wanted.g) <= tolerance(5, "of 255, the fit's 0.017"));
    CHECK(std::abs(found.b - wanted.b) <= tolerance(5, "of 255, the fit's 0.017"));
  }
}

TEST_CASE("a share beyond the scale has the colour of its end", "[render][Fig16]") {
  CHECK(color_of_share(-3.0f) == color_of_share(0.0f));
  CHECK(color_of_share(1.5f) == color_of_share(1.0f));
  CHECK_FALSE(color_of_share(0.0f) == color_of_share(1.0f));
}

TEST_CASE("what has two signs is darker the farther it is from 0, and as dark on both sides",
          "[render]") {
  const double light = luminance(two_sided_color_of_share(0.0f));
  double below = light, above = light;
  for (int i = 1; i <= 64; ++i) {
    const float share = static_cast<float>(i) / 64.0f;
    INFO("share " << share);
    const Rgb minus = two_sided_color_of_share(-share), plus = two_sided_color_of_share(share);
    CHECK(luminance(minus) < below);
    CHECK(luminance(plus) < above);
    below = luminance(minus);
    above = luminance(plus);
    CHECK(std::abs(below - above) < tolerance(0.05, "luminance, 1 is white"));
    // Also without vision of red or green one of the two is recognised as blue.
    if (i >= 16) CHECK(minus.b > minus.r + 40);
    if (i >= 16) CHECK(plus.r > plus.b + 40);
  }
  CHECK(two_sided_color_of_share(-3.0f) == two_sided_color_of_share(-1.0f));
  CHECK(two_sided_color_of_share(1.5f) == two_sided_color_of_share(1.0f));
}

TEST_CASE("what is near 0 on either side lets the material through", "[render]") {
  constexpr Rgb kOwn{30, 120, 40};
  for (const float sign : {-1.0f, 1.0f}) {
    CHECK(two_sided_color_of_share(0.02f * sign, kOwn, kOpaqueShare) == kOwn);
    CHECK_FALSE(two_sided_color_of_share(0.1f * sign, kOwn, kOpaqueShare) == kOwn);
    CHECK(two_sided_color_of_share(0.5f * sign, kOwn, kOpaqueShare) ==
          two_sided_color_of_share(0.5f * sign));
    CHECK(two_sided_color_of_share(0.02f * sign, kOwn, 0) ==
          two_sided_color_of_share(0.02f * sign));
    CHECK(two_sided_color_of_share(sign, kOwn, kNothingPainted) == kOwn);
  }
}

TEST_CASE("the shader paints the colours of the C++ function", "[render][Fig16]") {
  const Result<GlContext> context = GlContext::offscreen();
  if (!context.ok()) PALPABLE_SKIP(context.problem().message);
  constexpr int kCount = 201;
  std::vector<std::vector<float>> painted;
  for (int scale = 0; scale < 4; ++scale) {
    painted.push_back(on_gpu("color_map.glsl",
                             "vec4(color_map(i / 160.0 - 0.1, " + std::to_string(scale) + "), 1.0)",
                             kCount));
  }
  const std::vector<float> two_sided =
      on_gpu("color_map.glsl",
             "vec4(two_sided_painted(vec3(0.2, 0.6, 0.4), i / 80.0 - 1.2, 0.2), 1.0)", kCount);
  constexpr Rgb kBelow{51, 153, 102};
  const auto check_same = [](const float* found, Rgb expected) {
    const std::array<std::uint8_t, 3> bytes{expected.r, expected.g, expected.b};
    for (std::size_t c = 0; c < 3; ++c) {
      CHECK(std::abs(255.0f * found[c] - static_cast<float>(bytes[c])) <=
            tolerance(0.502, "rounding to a byte, and of terms up to 110 in single precision"));
    }
  };
  for (int i = 0; i < kCount; ++i) {
    INFO("sample " << i);
    const float at = static_cast<float>(i);
    for (std::size_t scale = 0; scale < painted.size(); ++scale) {
      check_same(painted[scale].data() + 4 * i,
                 color_of_share(at / 160.0f - 0.1f, static_cast<ColorScale>(scale)));
    }
    check_same(two_sided.data() + 4 * i, two_sided_color_of_share(at / 80.0f - 1.2f, kBelow, 0.2f));
  }
  CHECK(context.value().errors().count() == 0);
}

TEST_CASE("the shader hides what the C++ function hides", "[render][Fig9]") {
  const Result<GlContext> context = GlContext::offscreen();
  if (!context.ok()) PALPABLE_SKIP(context.problem().message);
  constexpr int kCount = 128;
  const std::vector<float> shares =
      on_gpu("depth.glsl",
             "vec4(hidden_share(0.5, 0.48 + 0.0002 * i), occlusion_bias(0.01 * i), "
             "window_depth(0.1 + 0.1 * i, 0.01), hidden_share(0.5, 0.0))",
             kCount);
  for (int i = 0; i < kCount; ++i) {
    INFO("sample " << i);
    const auto x = static_cast<float>(i);
    const float* at = shares.data() + 4 * i;
    CHECK(std::abs(at[0] - glsl::hidden_share(0.5f, 0.48f + 0.0002f * x)) <=
          tolerance(1e-3, "depths of 0.5 m differ by 3e-8, the ramp is 2.5 mm long"));
    CHECK(std::abs(at[1] - glsl::occlusion_bias(0.01f * x)) <= tolerance(1e-8, "rounding"));
    CHECK(std::abs(at[2] - glsl::window_depth(0.1f + 0.1f * x, 0.01f)) <=
          tolerance(1e-7, "rounding"));
    CHECK(at[3] == 0.0f);
  }
}

TEST_CASE("a real surface hides the body from the bias on and wholly from twice the bias on",
          "[render][Fig9]") {
  for (const float z : {0.2f, 0.5f, 1.0f, 2.0f}) {
    INFO("depth of the body " << z << " m");
    const float bias = glsl::occlusion_bias(z);
    CHECK(glsl::hidden_share(z, z) == 0.0f);
    CHECK(glsl::hidden_share(z, z + 1.0f) == 0.0f);
    CHECK(glsl::hidden_share(z, z - 0.95f * bias) == 0.0f);
    CHECK(glsl::hidden_share(z, z - 1.5f * bias) == Approx(0.5f).margin(1e-3));
    CHECK(glsl::hidden_share(z, z - 2.05f * bias) == 1.0f);
  }
  CHECK(glsl::occlusion_bias(2.0f) - glsl::occlusion_bias(0.0f) ==
        Approx(4 * (glsl::occlusion_bias(1.0f) - glsl::occlusion_bias(0.0f))));
}

TEST_CASE("an unknown depth hides nothing, whatever stands for it", "[render][Fig9]") {
  CHECK(glsl::hidden_share(0.5f, 0.0f) == 0.0f);
  CHECK(glsl::hidden_share(0.5f, -1.0f) == 0.0f);
  CHECK(glsl::hidden_share(0.5f, std::numeric_limits<float>::quiet_NaN()) == 0.0f);
}

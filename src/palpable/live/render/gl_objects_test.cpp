#include "palpable/live/render/gl_objects.h"

#include "palpable/live/render/gl_context.h"
#include "palpable/live/render/shader_files.h"
#include "tests/support/test.h"

#include <array>
#include <string>
#include <vector>

using namespace palpable;

namespace {
constexpr std::string_view kVertex = R"(#version 450 core
void main() {
  vec2 uv = vec2(float((gl_VertexID << 1) & 2), float(gl_VertexID & 2));
  gl_Position = vec4(2.0 * uv - 1.0, 0.0, 1.0);
}
)";
}  // namespace

TEST_CASE("a context without a screen offers OpenGL 4.5 and reports no error", "[render]") {
  const Result<GlContext> context = GlContext::offscreen();
  if (!context.ok()) PALPABLE_SKIP(context.problem().message);
  INFO(context.value().description());
  CHECK(epoxy_gl_version() >= 45);
  CHECK(context.value().errors().count() == 0);
}

TEST_CASE("an OpenGL error is counted and its first message kept", "[render]") {
  Result<GlContext> context = GlContext::offscreen();
  if (!context.ok()) PALPABLE_SKIP(context.problem().message);
  GlErrorLog& errors = context.value().errors();
  glBindTexture(GL_VERTEX_SHADER, 0);
  CHECK(errors.count() == 1);
  const std::string first = errors.first();  // the wording depends on the driver
  CHECK_FALSE(first.empty());
  glEnable(GL_TEXTURE_BUFFER);
  CHECK(errors.count() == 2);
  CHECK(errors.first() == first);
  errors.clear();
  CHECK(errors.count() == 0);
}

TEST_CASE("a second context does not disturb the first", "[render]") {
  Result<GlContext> first = GlContext::offscreen();
  if (!first.ok()) PALPABLE_SKIP(first.problem().message);
  {
    Result<GlContext> second = GlContext::offscreen();
    REQUIRE(second.ok());
    const GlTexture texture(GL_RGBA8, 3, 2);
    CHECK(second.value().errors().count() == 0);
  }
  first.value().make_current();
  const GlTexture texture(GL_RGBA8, 5, 4);
  CHECK(glIsTexture(texture.get()) == GL_TRUE);
  CHECK(first.value().errors().count() == 0);
}

TEST_CASE("what a program draws is read back with the first row first", "[render]") {
  Result<GlContext> context = GlContext::offscreen();
  if (!context.ok()) PALPABLE_SKIP(context.problem().message);
  const std::array<ShaderFile, 3> files{
      ShaderFile{"full.vert", kVertex},
      ShaderFile{"helper.glsl", "vec4 paint(vec2 p) { return vec4(p, COLOR, 1.0); }\n"},
      ShaderFile{"paint.frag",
                 "#version 450 core\n#include \"helper.glsl\"\nout vec4 color;\n"
                 "void main() { color = paint(floor(gl_FragCoord.xy)); }\n"}};
  const Result<GlProgram> program =
      GlProgram::make(files, "full.vert", "paint.frag", "#define COLOR 0.25\n");
  REQUIRE(program.ok());
  const GlTexture target(GL_RGBA32F, 5, 3);
  const std::array<const GlTexture*, 1> targets{&target};
  const GlFramebuffer framebuffer(targets, nullptr);
  framebuffer.bind();
  program.value().use();
  const FullScreenTriangle triangle;
  triangle.draw();
  std::vector<float> pixels(4 * 2 * 2);
  framebuffer.read(0, 1, 1, 2, 2, GL_RGBA, GL_FLOAT, pixels.data());
  CHECK(pixels ==
        std::vector<float>{1, 1, 0.25f, 1, 2, 1, 0.25f, 1, 1, 2, 0.25f, 1, 2, 2, 0.25f, 1});
  CHECK(context.value().errors().count() == 0);
}

TEST_CASE("a shader that does not compile is reported with its file and line", "[render]") {
  Result<GlContext> context = GlContext::offscreen();
  if (!context.ok()) PALPABLE_SKIP(context.problem().message);
  const std::array<ShaderFile, 4> files{
      ShaderFile{"full.vert", kVertex},
      ShaderFile{"bad.glsl", "float fine() { return 1.0; }\nfloat broken() { return oops; }\n"},
      ShaderFile{"inner.frag", "#version 450 core\n#include \"bad.glsl\"\nvoid main() {}\n"},
      ShaderFile{"outer.frag", "#version 450 core\nout vec4 c;\nvoid main() { c = nothing; }\n"}};
  const auto message = [&](std::string_view fragment, std::string_view defines) {
    const Result<GlProgram> program = GlProgram::make(files, "full.vert", fragment, defines);
    REQUIRE_FALSE(program.ok());
    INFO(program.problem().message);
    CHECK(program.problem().message.find('\n') == std::string::npos);
    return program.problem().message;
  };
  CHECK(message("inner.frag", "").find("bad.glsl:2") != std::string::npos);
  CHECK(message("outer.frag", "").find("outer.frag:3") != std::string::npos);
  CHECK(message("outer.frag", "#define A 1\n#define B 2\n").find("outer.frag:3") !=
        std::string::npos);
  CHECK(message("gone.frag", "").find("gone.frag") != std::string::npos);
}

TEST_CASE("programs are made in their order, and the first problem is all that comes back",
          "[render]") {
  Result<GlContext> context = GlContext::offscreen();
  if (!context.ok()) PALPABLE_SKIP(context.problem().message);
  const std::array<ShaderFile, 2> files{
      ShaderFile{"full.vert", kVertex},
      ShaderFile{"plain.frag",
                 "#version 450 core\nuniform float KEY;\nout vec4 c;\nvoid main() { c = vec4(KEY); "
                 "}\n"}};
  std::array<ProgramSource, 2> sources{
      ProgramSource{"full.vert", "plain.frag", "#define KEY one\n"},
      ProgramSource{"full.vert", "plain.frag"}};
  const Result<std::vector<GlProgram>> made = make_programs(files, sources);
  REQUIRE(made.ok());
  REQUIRE(made.value().size() == 2);
  made.value()[0].set("one", 1.0F);
  made.value()[1].set("KEY", 1.0F);
  sources[0].fragment = "gone.frag";
  sources[1].fragment = "lost.frag";
  const Result<std::vector<GlProgram>> none = make_programs(files, sources);
  REQUIRE_FALSE(none.ok());
  CHECK(none.problem().message.find("gone.frag") != std::string::npos);
}

TEST_CASE("an include that is missing is reported with the line that includes it", "[render]") {
  const std::array<ShaderFile, 2> files{
      ShaderFile{"full.vert", kVertex},
      ShaderFile{"lost.frag", "#version 450 core\n\n#include \"gone.glsl\"\nvoid main() {}\n"}};
  Result<GlContext> context = GlContext::offscreen();
  if (!context.ok()) PALPABLE_SKIP(context.problem().message);
  const Result<GlProgram> program = GlProgram::make(files, "full.vert", "lost.frag");
  REQUIRE_FALSE(program.ok());
  CHECK(program.problem().message == "no shader file 'gone.glsl' (included by lost.frag:3)");
}

TEST_CASE("a uniform that a program does not have is the caller's bug", "[render]") {
  Result<GlContext> context = GlContext::offscreen();
  if (!context.ok()) PALPABLE_SKIP(context.problem().message);
  const std::array<ShaderFile, 2> files{
      ShaderFile{"full.vert", kVertex},
      ShaderFile{"plain.frag", "#version 450 core\nout vec4 c;\nvoid main() { c = vec4(1.0); }\n"}};
  const Result<GlProgram> program = GlProgram::make(files, "full.vert", "plain.frag");
  REQUIRE(program.ok());
  CHECK_THROWS_AS(program.value().set("distance", 1.0f), ContractViolation);
}

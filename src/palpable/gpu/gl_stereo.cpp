#include "palpable/gpu/gl_stereo.h"

#include "palpable/base/contract.h"
#include "palpable/render/gl_objects.h"

#include <epoxy/gl.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace palpable {

std::span<const ShaderFile> gpu_shader_files();

namespace {

constexpr int kGroup = 64;  // invocations of a work group, as the shaders have it

std::string_view text_of(std::string_view name) {
  for (const ShaderFile& file : gpu_shader_files()) {
    if (file.name == name) return file.text;
  }
  PALPABLE_EXPECT(false, "a shader that is not there");
  return {};
}

std::string with_include(std::string_view name) {
  constexpr std::string_view kInclude = "#include \"stereo.glsl\"\n";
  std::string text(text_of(name));
  const auto at = text.find(kInclude);
  PALPABLE_EXPECT(at != std::string::npos, "every shader includes stereo.glsl");
  return text.replace(at, kInclude.size(), text_of("stereo.glsl"));
}

// Linked; the problem names the file.
Result<GLuint> compute_program(std::string_view name) {
  const std::string text = with_include(name);
  const char* source = text.c_str();
  const GLuint program = glCreateShaderProgramv(GL_COMPUTE_SHADER, 1, &source);
  GLint linked = GL_FALSE;
  if (program != 0) glGetProgramiv(program, GL_LINK_STATUS, &linked);
  if (linked == GL_TRUE) return program;
  std::array<char, 1024> log{};
  if (program != 0) glGetProgramInfoLog(program, log.size(), nullptr, log.data());
  glDeleteProgram(program);
  return Problem{std::string(name) + ": " + log.data()};
}

}  // namespace

struct GlStereo::Parts {
  detail::GlName<detail::delete_program> census;
  detail::GlName<detail::delete_program> path;
  detail::GlName<detail::delete_program> winner;
  GlBuffer luma;
  GlBuffer codes;
  GlBuffer sums;
  GlBuffer found;
  std::vector<std::uint32_t> words;
  std::vector<std::array<std::uint32_t, 2>> answers;

  static void set(const detail::GlName<detail::delete_program>& program, const char* name,
                  int value) {
    const GLint location = glGetUniformLocation(program.get(), name);
    // A shader that does not need a number may have lost it.
    if (location >= 0) glProgramUniform1i(program.get(), location, value);
  }
  static void run(int x, int y, int z) {
    glDispatchCompute(static_cast<GLuint>(x), static_cast<GLuint>(y), static_cast<GLuint>(z));
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
  }
};

GlStereo::GlStereo(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
GlStereo::GlStereo(GlStereo&&) noexcept = default;
GlStereo& GlStereo::operator=(GlStereo&&) noexcept = default;
GlStereo::~GlStereo() = default;

Result<GlStereo> GlStereo::make() {
  auto parts = std::make_unique<Parts>();
  for (auto& [name, program] :
       {std::pair{"census.comp", &parts->census}, std::pair{"path.comp", &parts->path},
        std::pair{"winner.comp", &parts->winner}}) {
    const Result<GLuint> made = compute_program(name);
    if (!made.ok()) return made.problem();
    *program = detail::GlName<detail::delete_program>(made.value());
  }
  return GlStereo(std::move(parts));
}

void GlStereo::find_winners(const GrayImage& left, const GrayImage& right, int first,
                            int disparities, const PathPenalties& penalties, Winners& winners) {
  PALPABLE_EXPECT(left.width() == right.width() && left.height() == right.height() && !left.empty(),
                  "both eyes see images of one size");
  PALPABLE_EXPECT(disparities >= 1 && disparities <= kMostDisparities && penalties.are_sound(),
                  "disparities and penalties as the plain loops have them");
  Parts& p = *parts_;
  const int W = left.width();
  const int H = left.height();
  const std::size_t pixels = left.size();
  p.words.resize(2 * pixels);
  std::copy(left.begin(), left.end(), p.words.begin());
  std::copy(right.begin(), right.end(), p.words.begin() + static_cast<std::ptrdiff_t>(pixels));
  p.luma.stream(std::span<const std::uint32_t>(p.words));
  p.codes.stream(std::span<const std::uint32_t>(p.words));  // of the right size, overwritten
  const std::size_t sums = pixels * static_cast<std::size_t>(disparities);
  p.words.assign(sums, 0);
  p.sums.stream(std::span<const std::uint32_t>(p.words));
  p.answers.resize(pixels);
  p.found.stream(p.answers.data(), 8 * pixels);
  GLuint binding = 0;
  for (const GlBuffer* buffer : {&p.luma, &p.codes, &p.sums, &p.found}) {
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding++, buffer->get());
  }
  for (const auto* program : {&p.census, &p.path, &p.winner}) {
    Parts::set(*program, "W", W);
    Parts::set(*program, "H", H);
    Parts::set(*program, "D", disparities);
    Parts::set(*program, "first", first);
  }
  Parts::set(p.path, "P1", penalties.p1);
  Parts::set(p.path, "P2", penalties.p2);
  Parts::set(p.path, "P2_LEAST", penalties.p2_least);
  Parts::set(p.census, "STEP", kCensusStep);
  Parts::set(p.path, "STRIPS", kStrips);
  Parts::set(p.path, "WARM_UP", kWarmUpRows);
  const int across = (W + kGroup - 1) / kGroup;
  glUseProgram(p.census.get());
  Parts::run(across, H, 2);
  glUseProgram(p.path.get());
  for (const int direction : {0, 1, 2}) {
    Parts::set(p.path, "DIRECTION", direction);
    Parts::run(direction == 2 ? W * kStrips : H, 1, 1);
  }
  glUseProgram(p.winner.get());
  Parts::run(across, H, 1);
  glGetNamedBufferSubData(p.found.get(), 0, static_cast<GLsizeiptr>(8 * pixels), p.answers.data());
  winners.resize(W, H);
  for (std::size_t i = 0; i < pixels; ++i) {
    const auto [best, sum] = p.answers[i];
    winners.best.data()[i] = static_cast<std::uint16_t>(best);
    winners.cost.data()[i] = static_cast<std::uint8_t>(sum);
    winners.before.data()[i] = static_cast<std::uint8_t>(sum >> 8U);
    winners.after.data()[i] = static_cast<std::uint8_t>(sum >> 16U);
  }
}

}  // namespace palpable

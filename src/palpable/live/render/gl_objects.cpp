#include "palpable/live/render/gl_objects.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <vector>

namespace palpable {
namespace detail {
void delete_program(GLuint name) { glDeleteProgram(name); }
void delete_buffer(GLuint name) { glDeleteBuffers(1, &name); }
void delete_vertex_array(GLuint name) { glDeleteVertexArrays(1, &name); }
void delete_texture(GLuint name) { glDeleteTextures(1, &name); }
void delete_framebuffer(GLuint name) { glDeleteFramebuffers(1, &name); }
}  // namespace detail

namespace {

const ShaderFile* find(std::span<const ShaderFile> files, std::string_view name) {
  const auto found = std::find_if(files.begin(), files.end(),
                                  [&](const ShaderFile& file) { return file.name == name; });
  return found == files.end() ? nullptr : &*found;
}

/// A shader with its includes inserted, and the origin of each line. `#line` is not used, because
/// Mesa loses the file number in errors that it finds after parsing.
struct ExpandedShader {
  struct Origin {
    std::string_view file;
    int line;
  };
  std::string text;
  std::vector<Origin> origins;               // one per line of text
  std::vector<std::string_view> files_seen;  // each is inserted once, so cycles end
  std::string problem;                       // empty: none

  void add(std::string_view line, Origin origin) {
    text += line;
    text += '\n';
    origins.push_back(origin);
  }
};

/// The lines of a text, without line ends.
std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    lines.push_back(text.substr(0, end));
    text = end == std::string_view::npos ? std::string_view{} : text.substr(end + 1);
  }
  return lines;
}

void expand(std::span<const ShaderFile> files, std::string_view name, std::string_view defines,
            ExpandedShader& out) {
  const ShaderFile* file = find(files, name);
  if (file == nullptr) {
    out.problem = fmt::format("no shader file '{}'", name);
    return;
  }
  if (std::find(out.files_seen.begin(), out.files_seen.end(), name) != out.files_seen.end()) return;
  out.files_seen.push_back(file->name);

  constexpr std::string_view kInclude = "#include \"";
  int line_number = 0;
  for (const std::string_view line : lines_of(file->text)) {
    ++line_number;
    if (line.starts_with(kInclude)) {
      const std::string_view quoted = line.substr(kInclude.size());
      expand(files, quoted.substr(0, quoted.find('"')), {}, out);
      if (!out.problem.empty()) {
        if (out.problem.find(" (included") == std::string::npos) {
          out.problem += fmt::format(" (included by {}:{})", name, line_number);
        }
        return;
      }
      continue;
    }
    out.add(line, {file->name, line_number});
    if (line.starts_with("#version")) {
      for (const std::string_view define : lines_of(defines)) out.add(define, {"defines", 1});
    }
  }
}

/// The first error of a driver's log, its line number in the expanded text replaced by file and
/// line: Mesa writes "0:12(5): error: ...", others "0(12) : error ...".
std::string readable_log(std::string_view log, const std::vector<ExpandedShader::Origin>& origins) {
  const std::vector<std::string_view> lines = lines_of(log);
  const auto error = std::find_if(lines.begin(), lines.end(), [](std::string_view line) {
    return line.find("error") != std::string_view::npos;
  });
  if (lines.empty()) return "the driver does not say why";
  const std::string line(error == lines.end() ? lines.front() : *error);
  std::size_t number = 0;
  int used = 0;
  if (std::sscanf(line.c_str(), "%*u%*1[:(]%zu%n", &number, &used) != 1) return line;
  if (number == 0 || number > origins.size()) return line;
  return fmt::format("{}:{}{}", origins[number - 1].file, origins[number - 1].line,
                     line.substr(used));
}

Result<GLuint> compile(std::span<const ShaderFile> files, std::string_view name, GLenum stage,
                       std::string_view defines) {
  ExpandedShader expanded;
  expand(files, name, defines, expanded);
  if (!expanded.problem.empty()) return Problem{expanded.problem};
  const GLuint shader = glCreateShader(stage);
  const char* text = expanded.text.c_str();
  glShaderSource(shader, 1, &text, nullptr);
  glCompileShader(shader);
  GLint good = GL_FALSE;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
  if (good == GL_TRUE) return shader;
  GLint length = 0;
  glGetShaderiv(shader, GL_INFO_LOG_LENGTH, &length);
  std::string log(std::max(length, 1), '\0');
  glGetShaderInfoLog(shader, length, nullptr, log.data());
  glDeleteShader(shader);
  return Problem{
      fmt::format("shader does not compile: {}", readable_log(log.c_str(), expanded.origins))};
}

}  // namespace

Result<GlProgram> GlProgram::make(std::span<const ShaderFile> files, std::string_view vertex,
                                  std::string_view fragment, std::string_view defines) {
  const Result<GLuint> vertex_shader = compile(files, vertex, GL_VERTEX_SHADER, defines);
  if (!vertex_shader.ok()) return vertex_shader.problem();
  const Result<GLuint> fragment_shader = compile(files, fragment, GL_FRAGMENT_SHADER, defines);
  if (!fragment_shader.ok()) {
    glDeleteShader(vertex_shader.value());
    return fragment_shader.problem();
  }
  GlProgram program(glCreateProgram());
  glAttachShader(program.get(), vertex_shader.value());
  glAttachShader(program.get(), fragment_shader.value());
  glLinkProgram(program.get());
  glDeleteShader(vertex_shader.value());  // deleted once no program has it attached
  glDeleteShader(fragment_shader.value());
  GLint good = GL_FALSE;
  glGetProgramiv(program.get(), GL_LINK_STATUS, &good);
  if (good == GL_TRUE) return program;
  GLint length = 0;
  glGetProgramiv(program.get(), GL_INFO_LOG_LENGTH, &length);
  std::string log(std::max(length, 1), '\0');
  glGetProgramInfoLog(program.get(), length, nullptr, log.data());
  return Problem{
      fmt::format("{} and {} do not link: {}", vertex, fragment, readable_log(log.c_str(), {}))};
}

Result<std::vector<GlProgram>> make_programs(std::span<const ShaderFile> files,
                                             std::span<const ProgramSource> sources) {
  std::vector<GlProgram> programs;
  for (const ProgramSource& source : sources) {
    Result<GlProgram> program =
        GlProgram::make(files, source.vertex, source.fragment, source.defines);
    if (!program.ok()) return program.problem();
    programs.push_back(std::move(program).value());
  }
  return programs;
}

GLint GlProgram::location(const char* uniform) const {
  const GLint found = glGetUniformLocation(get(), uniform);
  PALPABLE_EXPECT(found >= 0, fmt::format("the program has the uniform {}", uniform).c_str());
  return found;
}
void GlProgram::set(const char* uniform, int value) const {
  glProgramUniform1i(get(), location(uniform), value);
}
void GlProgram::set(const char* uniform, float value) const {
  glProgramUniform1f(get(), location(uniform), value);
}
void GlProgram::set(const char* uniform, const Eigen::Vector2f& value) const {
  glProgramUniform2fv(get(), location(uniform), 1, value.data());
}
void GlProgram::set(const char* uniform, const Eigen::Vector3f& value) const {
  glProgramUniform3fv(get(), location(uniform), 1, value.data());
}
void GlProgram::set(const char* uniform, const Eigen::Vector4f& value) const {
  glProgramUniform4fv(get(), location(uniform), 1, value.data());
}
void GlProgram::set(const char* uniform, const Eigen::Matrix3f& value) const {
  glProgramUniformMatrix3fv(get(), location(uniform), 1, GL_FALSE, value.data());
}
void GlProgram::set(const char* uniform, const Eigen::Matrix4f& value) const {
  glProgramUniformMatrix4fv(get(), location(uniform), 1, GL_FALSE, value.data());
}
void GlProgram::set(const char* uniform, std::span<const Eigen::Vector4f> values) const {
  if (values.empty()) return;
  glProgramUniform4fv(get(), location(uniform), static_cast<GLsizei>(values.size()),
                      values.front().data());
}
void GlProgram::set(const char* uniform, std::span<const Eigen::Matrix3f> values) const {
  if (values.empty()) return;
  glProgramUniformMatrix3fv(get(), location(uniform), static_cast<GLsizei>(values.size()), GL_FALSE,
                            values.front().data());
}

GlBuffer::GlBuffer() {
  GLuint name = 0;
  glCreateBuffers(1, &name);
  name_ = detail::GlName<detail::delete_buffer>(name);
}

void GlBuffer::stream(const void* data, std::size_t bytes) {
  capacity_ = std::max(capacity_, bytes);
  // Allocating the same size again tells the driver that the old content is not needed.
  glNamedBufferData(get(), static_cast<GLsizeiptr>(capacity_), nullptr, GL_STREAM_DRAW);
  if (bytes > 0) glNamedBufferSubData(get(), 0, static_cast<GLsizeiptr>(bytes), data);
}

GlVertexArray::GlVertexArray() {
  GLuint name = 0;
  glCreateVertexArrays(1, &name);
  name_ = detail::GlName<detail::delete_vertex_array>(name);
}

void GlVertexArray::floats(GLuint location, const GlBuffer& buffer, int components, int stride,
                           int offset, bool per_instance) {
  const int step = stride > 0 ? stride : components * static_cast<int>(sizeof(float));
  glVertexArrayVertexBuffer(name_.get(), location, buffer.get(), offset, step);
  glVertexArrayAttribFormat(name_.get(), location, components, GL_FLOAT, GL_FALSE, 0);
  glVertexArrayAttribBinding(name_.get(), location, location);
  glVertexArrayBindingDivisor(name_.get(), location, per_instance ? 1 : 0);
  glEnableVertexArrayAttrib(name_.get(), location);
}

void GlVertexArray::bytes(GLuint location, const GlBuffer& buffer, int stride, int offset) {
  glVertexArrayVertexBuffer(name_.get(), location, buffer.get(), offset, stride);
  glVertexArrayAttribFormat(name_.get(), location, 4, GL_UNSIGNED_BYTE, GL_TRUE, 0);
  glVertexArrayAttribBinding(name_.get(), location, location);
  glEnableVertexArrayAttrib(name_.get(), location);
}

void GlVertexArray::indices(const GlBuffer& buffer) {
  glVertexArrayElementBuffer(name_.get(), buffer.get());
}

GlTexture::GlTexture(GLenum format, int width, int height, GLenum filter, int levels)
    : width_(width), height_(height) {
  PALPABLE_EXPECT(width > 0 && height > 0 && levels > 0, "a texture has a size");
  GLuint name = 0;
  glCreateTextures(GL_TEXTURE_2D, 1, &name);
  name_ = detail::GlName<detail::delete_texture>(name);
  glTextureStorage2D(name, levels, format, width, height);
  const GLint mag = static_cast<GLint>(filter);
  const GLint min = levels > 1 ? GL_LINEAR_MIPMAP_LINEAR : mag;
  glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, min);
  glTextureParameteri(name, GL_TEXTURE_MAG_FILTER, mag);
  glTextureParameteri(name, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTextureParameteri(name, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
}

void GlTexture::upload(int x, int y, int width, int height, GLenum layout, GLenum type,
                       const void* pixels, int row_length) {
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glPixelStorei(GL_UNPACK_ROW_LENGTH, row_length);
  glTextureSubImage2D(get(), 0, x, y, width, height, layout, type, pixels);
  glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
}

void GlTexture::repeat() {
  glTextureParameteri(get(), GL_TEXTURE_WRAP_S, GL_REPEAT);
  glTextureParameteri(get(), GL_TEXTURE_WRAP_T, GL_REPEAT);
}

GlTextureArray::GlTextureArray(GLenum format, int width, int height, int layers, GLenum filter)
    : width_(width), height_(height), layers_(layers) {
  PALPABLE_EXPECT(width > 0 && height > 0 && layers > 0, "an array of textures has a size");
  GLuint name = 0;
  glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &name);
  name_ = detail::GlName<detail::delete_texture>(name);
  glTextureStorage3D(name, 1, format, width, height, layers);
  glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, static_cast<GLint>(filter));
  glTextureParameteri(name, GL_TEXTURE_MAG_FILTER, static_cast<GLint>(filter));
  glTextureParameteri(name, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTextureParameteri(name, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
}

GlFramebuffer::GlFramebuffer(const GlTextureArray& colors, int layer, const GlTexture& depth)
    : width_(colors.width()), height_(colors.height()) {
  PALPABLE_EXPECT(layer >= 0 && layer < colors.layers(), "the array has that layer");
  GLuint name = 0;
  glCreateFramebuffers(1, &name);
  name_ = detail::GlName<detail::delete_framebuffer>(name);
  glNamedFramebufferTextureLayer(name, GL_COLOR_ATTACHMENT0, colors.get(), 0, layer);
  glNamedFramebufferTexture(name, GL_DEPTH_ATTACHMENT, depth.get(), 0);
  PALPABLE_EXPECT(
      glCheckNamedFramebufferStatus(name, GL_DRAW_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE,
      "the attachments of a framebuffer fit together");
}

GlFramebuffer::GlFramebuffer(std::span<const GlTexture* const> colors, const GlTexture* depth) {
  const GlTexture* any = colors.empty() ? depth : colors.front();
  PALPABLE_EXPECT(any != nullptr, "a framebuffer has something to draw into");
  width_ = any->width();
  height_ = any->height();
  GLuint name = 0;
  glCreateFramebuffers(1, &name);
  name_ = detail::GlName<detail::delete_framebuffer>(name);
  std::vector<GLenum> buffers;
  for (const GlTexture* color : colors) {
    const auto attachment = static_cast<GLenum>(GL_COLOR_ATTACHMENT0 + buffers.size());
    glNamedFramebufferTexture(name, attachment, color->get(), 0);
    buffers.push_back(attachment);
  }
  if (buffers.empty()) buffers.push_back(GL_NONE);
  glNamedFramebufferDrawBuffers(name, static_cast<GLsizei>(buffers.size()), buffers.data());
  if (depth != nullptr) glNamedFramebufferTexture(name, GL_DEPTH_ATTACHMENT, depth->get(), 0);
  PALPABLE_EXPECT(
      glCheckNamedFramebufferStatus(name, GL_DRAW_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE,
      "the attachments of a framebuffer fit together");
}

void GlFramebuffer::bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, get());
  glViewport(0, 0, width_, height_);
}

void GlFramebuffer::read(int attachment, int x, int y, int width, int height, GLenum layout,
                         GLenum type, void* pixels) const {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, get());
  glReadBuffer(static_cast<GLenum>(GL_COLOR_ATTACHMENT0 + attachment));
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(x, y, width, height, layout, type, pixels);
}

void FullScreenTriangle::draw() const {
  empty_.bind();
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace palpable

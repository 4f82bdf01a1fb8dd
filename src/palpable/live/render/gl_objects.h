/// @file
/// Owners of OpenGL objects: programs, buffers, vertex arrays, textures, framebuffers.
///
/// All are move-only. Their destructors delete the object; the context must be current then. They
/// use direct state access (4.5), so that creating or filling an object changes no binding.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/image.h"

#include <Eigen/Core>
#include <epoxy/gl.h>

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace palpable {

/// One file of a module's shaders folder, compiled into the program
/// (palpable_embed_shaders in cmake/EmbedFiles.cmake).
struct ShaderFile {
  std::string_view name;  ///< e.g. "body.frag"
  std::string_view text;
};

/// A colour as shaders take it: 0 to 1 for each component.
[[nodiscard]] inline Eigen::Vector3f shader_color(Rgb color) {
  return Eigen::Vector3f(color.r, color.g, color.b) / 255.0f;
}

namespace detail {
/// An OpenGL name and the function that deletes it.
template <void (*remove)(GLuint)>
class GlName {
 public:
  GlName() = default;
  explicit GlName(GLuint name) : name_(name) {}
  GlName(GlName&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
  GlName& operator=(GlName&& other) noexcept {
    std::swap(name_, other.name_);
    return *this;
  }
  ~GlName() {
    if (name_ != 0) remove(name_);
  }
  [[nodiscard]] GLuint get() const { return name_; }

 private:
  GLuint name_ = 0;
};
void delete_program(GLuint name);
void delete_buffer(GLuint name);
void delete_vertex_array(GLuint name);
void delete_texture(GLuint name);
void delete_framebuffer(GLuint name);
}  // namespace detail

/// A vertex and a fragment shader, linked; or one compute shader.
///
/// A line `#include "name"` in a shader is replaced by that file of the same set. Errors name the
/// file and the line as they are on disk.
class GlProgram {
 public:
  /// @param files     all files that may be named here or included
  /// @param vertex    name in `files`, with its #version line
  /// @param fragment  likewise
  /// @param defines   lines put below #version, e.g. "#define SAMPLES 4\n"
  [[nodiscard]] static Result<GlProgram> make(std::span<const ShaderFile> files,
                                              std::string_view vertex, std::string_view fragment,
                                              std::string_view defines = {});

  void use() const { glUseProgram(name_.get()); }
  [[nodiscard]] GLuint get() const { return name_.get(); }

  /// Sets a uniform by name; the program need not be in use.
  /// @throws ContractViolation if the program has no such uniform (compilers drop unused ones)
  void set(const char* uniform, int value) const;
  void set(const char* uniform, float value) const;
  void set(const char* uniform, const Eigen::Vector2f& value) const;
  void set(const char* uniform, const Eigen::Vector3f& value) const;
  void set(const char* uniform, const Eigen::Vector4f& value) const;
  void set(const char* uniform, const Eigen::Matrix3f& value) const;
  void set(const char* uniform, const Eigen::Matrix4f& value) const;
  void set(const char* uniform, std::span<const Eigen::Vector4f> values) const;
  void set(const char* uniform, std::span<const Eigen::Matrix3f> values) const;

 private:
  explicit GlProgram(GLuint name) : name_(name) {}
  [[nodiscard]] GLint location(const char* uniform) const;
  detail::GlName<detail::delete_program> name_;
};

/// Arguments of GlProgram::make besides the files.
struct ProgramSource {
  std::string_view vertex, fragment;
  std::string_view defines = {};
};

/// Makes one program for each of `sources`, in the same order; or returns the first problem.
[[nodiscard]] Result<std::vector<GlProgram>> make_programs(std::span<const ShaderFile> files,
                                                           std::span<const ProgramSource> sources);

/// A buffer whose storage grows as needed and never shrinks.
class GlBuffer {
 public:
  GlBuffer();
  /// Replaces the content. The driver keeps the old storage for frames that are still being drawn
  /// with it, so the call does not wait for them.
  void stream(const void* data, std::size_t bytes);
  template <class T>
  void stream(std::span<const T> values) {
    stream(values.data(), values.size_bytes());
  }
  [[nodiscard]] GLuint get() const { return name_.get(); }
  [[nodiscard]] std::size_t capacity() const { return capacity_; }

 private:
  detail::GlName<detail::delete_buffer> name_;
  std::size_t capacity_ = 0;
};

/// Assigns a buffer to each input of a vertex shader.
class GlVertexArray {
 public:
  GlVertexArray();
  /// Input `location` reads `components` floats per vertex (or instance) from `buffer`, packed.
  /// A stride or offset of interleaved data is in bytes; stride 0 means tightly packed.
  void floats(GLuint location, const GlBuffer& buffer, int components, int stride = 0,
              int offset = 0, bool per_instance = false);
  /// Input `location` reads four bytes per vertex, 0 .. 255 as 0 .. 1; see floats().
  void bytes(GLuint location, const GlBuffer& buffer, int stride, int offset);
  void indices(const GlBuffer& buffer);
  void bind() const { glBindVertexArray(name_.get()); }

 private:
  detail::GlName<detail::delete_vertex_array> name_;
};

/// A 2D texture of fixed format and size.
class GlTexture {
 public:
  GlTexture() = default;
  /// @param format  sized: GL_RGBA8, GL_R32F, GL_R8, GL_DEPTH_COMPONENT32F, ...
  /// @param filter  GL_NEAREST or GL_LINEAR; coordinates are clamped to the edge
  /// @param levels  mip levels; more than 1 turns trilinear filtering on
  GlTexture(GLenum format, int width, int height, GLenum filter = GL_NEAREST, int levels = 1);

  /// Replaces a rectangle of level 0.
  /// @param row_length  pixels from one row of `pixels` to the next; 0 means `width`
  void upload(int x, int y, int width, int height, GLenum layout, GLenum type, const void* pixels,
              int row_length = 0);
  void make_mipmaps() { glGenerateTextureMipmap(name_.get()); }
  void repeat();  ///< coordinates wrap around instead of being clamped
  void bind(int unit) const { glBindTextureUnit(static_cast<GLuint>(unit), name_.get()); }

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] GLuint get() const { return name_.get(); }

 private:
  detail::GlName<detail::delete_texture> name_;
  int width_ = 0;
  int height_ = 0;
};

/// An array texture: 2D layers of one size and format.
class GlTextureArray {
 public:
  GlTextureArray() = default;
  /// @param format, filter  as GlTexture's; coordinates are clamped to the edge
  GlTextureArray(GLenum format, int width, int height, int layers, GLenum filter = GL_NEAREST);
  void bind(int unit) const { glBindTextureUnit(static_cast<GLuint>(unit), name_.get()); }

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] int layers() const { return layers_; }
  [[nodiscard]] GLuint get() const { return name_.get(); }

 private:
  detail::GlName<detail::delete_texture> name_;
  int width_ = 0;
  int height_ = 0;
  int layers_ = 0;
};

/// Textures to draw into. They must outlive this object.
class GlFramebuffer {
 public:
  GlFramebuffer() = default;
  /// @param colors  attachment i is colors[i]
  /// @param depth   null for none
  /// @throws ContractViolation when OpenGL calls the combination incomplete
  GlFramebuffer(std::span<const GlTexture* const> colors, const GlTexture* depth);
  /// Has one layer of an array as its only colour attachment.
  GlFramebuffer(const GlTextureArray& colors, int layer, const GlTexture& depth);

  /// Directs drawing to this framebuffer; the viewport becomes all of it.
  void bind() const;

  /// Reads a rectangle of one attachment, first row first.
  void read(int attachment, int x, int y, int width, int height, GLenum layout, GLenum type,
            void* pixels) const;

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] GLuint get() const { return name_.get(); }

 private:
  detail::GlName<detail::delete_framebuffer> name_;
  int width_ = 0;
  int height_ = 0;
};

/// Draws one triangle that covers the viewport, without any vertex buffer: the vertex shader makes
/// it from gl_VertexID (full_screen.vert).
class FullScreenTriangle {
 public:
  void draw() const;

 private:
  GlVertexArray empty_;
};

}  // namespace palpable

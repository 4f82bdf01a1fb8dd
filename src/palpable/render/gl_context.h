/// @file
/// An OpenGL 4.5 core context without a screen, and the list of what went wrong in it.
///
/// Everything about EGL is in gl_context.cpp; the one other way to a context is window.h. Mesa's
/// llvmpipe is enough: no GPU, no display, no X server.
#pragma once

#include "palpable/base/error.h"

#include <memory>
#include <string>

namespace palpable {

/// Collects what the driver reports as an error (KHR_debug), from the moment it is attached.
///
/// A GL error is a bug of ours. Tests require count() == 0; programs end with throw_if_any().
class GlErrorLog {
 public:
  /// Listens to the context that is current on this thread, synchronously. The log must outlive
  /// the context and keep its address.
  void attach();

  [[nodiscard]] int count() const { return count_; }
  /// The first message; empty when count() is 0.
  [[nodiscard]] const std::string& first() const { return first_; }
  /// @throws Error with the count and the first message when there are errors
  void throw_if_any() const;

  void add(const char* message);
  void clear();

 private:
  int count_ = 0;
  std::string first_;
};

/// A context that draws into framebuffers of its own only. Move-only. Belongs to the thread on
/// which it was made current last; at most one context is current per thread.
class GlContext {
 public:
  /// Makes a context and makes it current. Tries Mesa's surfaceless platform first, then every EGL
  /// device. The problem says which step failed and which package usually helps.
  [[nodiscard]] static Result<GlContext> offscreen();

  GlContext(GlContext&&) noexcept;
  GlContext& operator=(GlContext&&) noexcept;
  ~GlContext();

  void make_current();

  [[nodiscard]] const GlErrorLog& errors() const;
  [[nodiscard]] GlErrorLog& errors();
  /// Renderer and version as the driver names them, e.g. "llvmpipe (LLVM 15.0.6, 256 bits), 4.5".
  [[nodiscard]] const std::string& description() const;

 private:
  struct State;
  explicit GlContext(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace palpable

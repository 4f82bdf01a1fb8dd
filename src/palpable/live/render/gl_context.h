/// @file
/// An OpenGL 4.5 core context without a screen, and a log of its errors.
///
/// Only gl_context.cpp uses EGL; window.h makes contexts with a window. Mesa's llvmpipe suffices:
/// no GPU, no display and no X server are needed.
#pragma once

#include "palpable/common/base/error.h"

#include <memory>
#include <string>

namespace palpable {

/// Sets how many threads besides the caller's a software renderer (Mesa's llvmpipe) may use; 0: the
/// caller's thread alone. Sets LP_NUM_THREADS unless the user has set it. To be called before the
/// first context of the process is made, while no other thread runs. @param threads  >= 0
void use_drawing_threads(int threads);

/// Collects the errors that the driver reports (KHR_debug) once it is attached.
///
/// An OpenGL error is a bug of this program. Tests require count() == 0; programs call
/// throw_if_any() at their end.
class GlErrorLog {
 public:
  /// Logs the errors of the context that is current on this thread, synchronously. The log must
  /// outlive the context and keep its address.
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

/// A context without a window, which draws into framebuffer objects only. Move-only. It belongs to
/// the thread that made it current last; a thread has at most one current context.
class GlContext {
 public:
  /// Creates a context and makes it current. Tries Mesa's surfaceless platform first, then every
  /// EGL device. The problem names the step that failed and the package that usually helps.
  [[nodiscard]] static Result<GlContext> offscreen();

  GlContext(GlContext&&) noexcept;
  GlContext& operator=(GlContext&&) noexcept;
  ~GlContext();

  /// Makes the context current on the calling thread. @throws ContractViolation if another thread
  /// has it
  void make_current();

  /// The errors since the context was created or the log was cleared.
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

#include "palpable/live/render/gl_context.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <fmt/core.h>

#include <array>
#include <cstdlib>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace palpable {
namespace {

void on_message(GLenum /*source*/, GLenum type, GLuint /*id*/, GLenum /*severity*/,
                GLsizei /*length*/, const GLchar* message, const void* user) {
  if (type != GL_DEBUG_TYPE_ERROR) return;
  // KHR_debug returns the pointer that attach() passed, which was not const.
  static_cast<GlErrorLog*>(const_cast<void*>(user))->add(message);
}

const char* text_of(EGLint error) {
  switch (error) {
    case EGL_SUCCESS:
      return "no error reported";
    case EGL_NOT_INITIALIZED:
      return "not initialised";
    case EGL_BAD_ALLOC:
      return "out of resources";
    case EGL_BAD_ATTRIBUTE:
      return "an attribute is not known";
    case EGL_BAD_CONFIG:
      return "no such configuration";
    case EGL_BAD_MATCH:
      return "OpenGL 4.5 core is not supported";
    default:
      return "failed";
  }
}

bool has_word(const char* list, std::string_view word) {
  if (list == nullptr) return false;
  const std::string padded = fmt::format(" {} ", list);
  return padded.find(fmt::format(" {} ", word)) != std::string::npos;
}

/// The displays to try, best first. EGL returns the same display object to every caller in the
/// process, so displays are not terminated here.
std::vector<EGLDisplay> displays_without_screen() {
  std::vector<EGLDisplay> displays;
  const char* extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  if (!has_word(extensions, "EGL_EXT_platform_base")) return displays;
  if (has_word(extensions, "EGL_MESA_platform_surfaceless")) {
    displays.push_back(
        eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
  }
  if (has_word(extensions, "EGL_EXT_platform_device") &&
      (has_word(extensions, "EGL_EXT_device_enumeration") ||
       has_word(extensions, "EGL_EXT_device_base"))) {
    std::array<EGLDeviceEXT, 16> devices{};
    EGLint count = 0;
    if (eglQueryDevicesEXT(static_cast<EGLint>(devices.size()), devices.data(), &count) ==
        EGL_TRUE) {
      for (EGLint i = 0; i < count; ++i) {
        displays.push_back(eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[i], nullptr));
      }
    }
  }
  return displays;
}

/// A context on this display, or the step that failed.
Result<EGLContext> make_context(EGLDisplay display) {
  const auto failed = [](const char* step) {
    return Problem{fmt::format("{}: {}", step, text_of(eglGetError()))};
  };
  if (display == EGL_NO_DISPLAY || eglInitialize(display, nullptr, nullptr) != EGL_TRUE) {
    return failed("eglInitialize");
  }
  if (!has_word(eglQueryString(display, EGL_EXTENSIONS), "EGL_KHR_surfaceless_context")) {
    return Problem{"the driver cannot draw without a surface (EGL_KHR_surfaceless_context)"};
  }
  if (eglBindAPI(EGL_OPENGL_API) != EGL_TRUE) return failed("eglBindAPI(OpenGL)");
  const std::array<EGLint, 5> wanted_config{EGL_SURFACE_TYPE, EGL_DONT_CARE, EGL_RENDERABLE_TYPE,
                                            EGL_OPENGL_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  if (eglChooseConfig(display, wanted_config.data(), &config, 1, &count) != EGL_TRUE ||
      count == 0) {
    return failed("eglChooseConfig");
  }
  const std::array<EGLint, 9> wanted_context{EGL_CONTEXT_MAJOR_VERSION,
                                             4,
                                             EGL_CONTEXT_MINOR_VERSION,
                                             5,
                                             EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                             EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                             EGL_CONTEXT_OPENGL_DEBUG,
                                             EGL_TRUE,
                                             EGL_NONE};
  EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, wanted_context.data());
  if (context == EGL_NO_CONTEXT) return failed("eglCreateContext");
  return context;
}

}  // namespace

void use_drawing_threads(int threads) {
  PALPABLE_EXPECT(threads >= 0, "no fewer threads than none");
  constexpr int kKeepWhatTheUserSays = 0;
  ::setenv("LP_NUM_THREADS", std::to_string(threads).c_str(), kKeepWhatTheUserSays);
}

void GlErrorLog::attach() {
  glEnable(GL_DEBUG_OUTPUT);
  glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
  glDebugMessageCallback(on_message, this);
}

void GlErrorLog::throw_if_any() const {
  if (count_ > 0)
    throw Error(fmt::format("OpenGL reported {} errors, the first: {}", count_, first_));
}

void GlErrorLog::add(const char* message) {
  if (count_++ == 0) first_ = message;
}

void GlErrorLog::clear() {
  count_ = 0;
  first_.clear();
}

struct GlContext::State {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;
  GlErrorLog errors;
  std::string description;

  State() = default;
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    if (context == EGL_NO_CONTEXT) return;
    if (eglGetCurrentContext() == context) {
      eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    }
    eglDestroyContext(display, context);
  }
};

Result<GlContext> GlContext::offscreen() {
  std::string why = "EGL offers no platform without a screen";
  for (EGLDisplay display : displays_without_screen()) {
    Result<EGLContext> context = make_context(display);
    if (!context.ok()) {
      why = context.problem().message;
      continue;
    }
    auto state = std::make_unique<State>();
    state->display = display;
    state->context = context.value();
    if (eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, state->context) != EGL_TRUE) {
      why = fmt::format("eglMakeCurrent: {}", text_of(eglGetError()));
      continue;
    }
    state->errors.attach();
    state->description =
        fmt::format("{}, {}", reinterpret_cast<const char*>(glGetString(GL_RENDERER)),
                    reinterpret_cast<const char*>(glGetString(GL_VERSION)));
    return GlContext(std::move(state));
  }
  return Problem{
      fmt::format("no OpenGL 4.5 context without a screen: {}; on Debian, the packages libegl1 and "
                  "libgl1-mesa-dri bring one that needs no GPU",
                  why)};
}

GlContext::GlContext(std::unique_ptr<State> state) : state_(std::move(state)) {}
GlContext::GlContext(GlContext&&) noexcept = default;
GlContext& GlContext::operator=(GlContext&&) noexcept = default;
GlContext::~GlContext() = default;

void GlContext::make_current() {
  // Fails only if the context is current on another thread, which is a bug of the caller.
  PALPABLE_EXPECT(
      eglMakeCurrent(state_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, state_->context) == EGL_TRUE,
      "a context is current on one thread at a time");
}

const GlErrorLog& GlContext::errors() const { return state_->errors; }
GlErrorLog& GlContext::errors() { return state_->errors; }
const std::string& GlContext::description() const { return state_->description; }

}  // namespace palpable

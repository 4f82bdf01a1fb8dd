#include "palpable/render/window.h"

#include "palpable/render/gl_objects.h"

#include <epoxy/gl.h>
// Included after epoxy, so that GLFW does not include OpenGL's own header.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace palpable {
namespace {

std::string glfw_reason() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text != nullptr ? text : "no reason given";
}

/// The picture's rectangle in the window's framebuffer, px from its lower left corner.
struct Placement {
  int x = 0, y = 0, width = 1, height = 1;
};

Placement fit(int picture_width, int picture_height, int width, int height) {
  const double scale = std::min(static_cast<double>(width) / picture_width,
                                static_cast<double>(height) / picture_height);
  Placement at;
  at.width = std::max(static_cast<int>(std::lround(picture_width * scale)), 1);
  at.height = std::max(static_cast<int>(std::lround(picture_height * scale)), 1);
  at.x = (width - at.width) / 2;
  at.y = (height - at.height) / 2;
  return at;
}

}  // namespace

struct Window::State {
  GLFWwindow* window = nullptr;
  GlErrorLog errors;
  std::vector<WindowEvent> gathered, handed_out;
  // The picture last shown, and its rectangle in the window.
  int picture_width = 1, picture_height = 1;
  struct Surface {
    GlTexture texture;
    GlFramebuffer framebuffer;
  };
  std::unique_ptr<Surface> surface;

  State() = default;
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    if (window == nullptr) return;
    glfwMakeContextCurrent(window);
    surface.reset();
    glfwDestroyWindow(window);
    if (--open_windows == 0) glfwTerminate();
  }

  static int open_windows;  // GLFW is terminated with the last one

  static State& of(GLFWwindow* window) {
    return *static_cast<State*>(glfwGetWindowUserPointer(window));
  }

  void gather(WindowEvent event) {
    double x = 0, y = 0;
    int window_width = 1, window_height = 1;
    glfwGetCursorPos(window, &x, &y);
    glfwGetWindowSize(window, &window_width, &window_height);
    const Placement at =
        fit(picture_width, picture_height, std::max(window_width, 1), std::max(window_height, 1));
    event.x_px = (x - at.x) * picture_width / at.width - 0.5;
    event.y_px = (y - at.y) * picture_height / at.height - 0.5;
    gathered.push_back(event);
  }
};

int Window::State::open_windows = 0;

Result<Window> Window::open(const std::string& title, int width, int height) {
  PALPABLE_EXPECT(width > 0 && height > 0, "a window has a size");
  if (glfwInit() != GLFW_TRUE) {
    return Problem{fmt::format("cannot open a window: {}", glfw_reason())};
  }
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, GLFW_TRUE);
  auto state = std::make_unique<State>();
  GLFWwindow* window = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
  if (window == nullptr) {
    const std::string reason = glfw_reason();
    if (State::open_windows == 0) glfwTerminate();
    return Problem{fmt::format("cannot open a window with OpenGL 4.5: {}", reason)};
  }
  ++State::open_windows;
  state->window = window;
  state->picture_width = width;
  state->picture_height = height;
  glfwSetWindowUserPointer(window, state.get());
  glfwMakeContextCurrent(window);
  glfwSwapInterval(1);
  state->errors.attach();

  glfwSetMouseButtonCallback(window, [](GLFWwindow* w, int button, int action, int /*mods*/) {
    WindowEvent event;
    event.kind = action == GLFW_PRESS ? WindowEvent::Kind::kPress : WindowEvent::Kind::kRelease;
    event.button = button;
    State::of(w).gather(event);
  });
  glfwSetCursorPosCallback(window, [](GLFWwindow* w, double /*x*/, double /*y*/) {
    State::of(w).gather({.kind = WindowEvent::Kind::kMove});
  });
  glfwSetScrollCallback(window, [](GLFWwindow* w, double /*x*/, double y) {
    WindowEvent event;
    event.kind = WindowEvent::Kind::kWheel;
    event.wheel = y;
    State::of(w).gather(event);
  });
  glfwSetKeyCallback(window, [](GLFWwindow* w, int key, int /*scan*/, int action, int /*mods*/) {
    if (action != GLFW_PRESS) return;
    WindowEvent event;
    event.kind = WindowEvent::Kind::kKey;
    event.key = key;
    State::of(w).gather(event);
  });
  static_assert(WindowEvent::kEscape == GLFW_KEY_ESCAPE);
  return Window(std::move(state));
}

Window::Window(std::unique_ptr<State> state) : state_(std::move(state)) {}
Window::Window(Window&&) noexcept = default;
Window& Window::operator=(Window&&) noexcept = default;
Window::~Window() = default;

void Window::show(const ColorImage& picture) {
  PALPABLE_EXPECT(!picture.empty(), "a picture has pixels");
  State& s = *state_;
  s.picture_width = picture.width();
  s.picture_height = picture.height();
  if (!s.surface || s.surface->texture.width() != picture.width() ||
      s.surface->texture.height() != picture.height()) {
    s.surface = std::make_unique<State::Surface>();
    s.surface->texture = GlTexture(GL_RGBA8, picture.width(), picture.height());
    s.surface->framebuffer =
        GlFramebuffer(std::array<const GlTexture*, 1>{&s.surface->texture}, nullptr);
  }
  s.surface->texture.upload(0, 0, picture.width(), picture.height(), GL_RGB, GL_UNSIGNED_BYTE,
                            picture.data());
  int width = 1, height = 1;
  glfwGetFramebufferSize(s.window, &width, &height);
  if (width > 0 && height > 0) {  // 0 while it is minimised
    const Placement at = fit(picture.width(), picture.height(), width, height);
    glDisable(GL_SCISSOR_TEST);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    if (at.width != width || at.height != height) {
      glClearColor(0, 0, 0, 1);
      glClear(GL_COLOR_BUFFER_BIT);
    }
    // Row 0 of the picture is at the top, row 0 of the window at the bottom.
    glBlitNamedFramebuffer(s.surface->framebuffer.get(), 0, 0, 0, picture.width(), picture.height(),
                           at.x, at.y + at.height, at.x + at.width, at.y, GL_COLOR_BUFFER_BIT,
                           at.width == picture.width() ? GL_NEAREST : GL_LINEAR);
  }
  glfwSwapBuffers(s.window);
}

std::span<const WindowEvent> Window::events(double wait) {
  State& s = *state_;
  if (wait > 0 && s.gathered.empty()) {
    glfwWaitEventsTimeout(wait);
  } else {
    glfwPollEvents();
  }
  std::swap(s.gathered, s.handed_out);
  s.gathered.clear();
  return s.handed_out;
}

bool Window::closed() const { return glfwWindowShouldClose(state_->window) == GLFW_TRUE; }

void Window::make_current() { glfwMakeContextCurrent(state_->window); }

const GlErrorLog& Window::gl_errors() const { return state_->errors; }

}  // namespace palpable

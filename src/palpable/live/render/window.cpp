#include "palpable/live/render/window.h"

#include "palpable/live/render/gl_objects.h"

#include <epoxy/gl.h>
// Included after epoxy, so that GLFW does not include OpenGL's own header.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/core.h>

#include <array>
#include <cctype>
#include <cstring>
#include <optional>
#include <utility>
#include <vector>

namespace palpable {
namespace {

std::string glfw_reason() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text != nullptr ? text : "no reason given";
}

// The letter of a key in the user's keyboard layout. GLFW's own numbers denote positions on a US
// keyboard, where another layout may have another letter.
int layout_key(int key, int scancode) {
  const char* name = glfwGetKeyName(key, scancode);
  if (name == nullptr || std::strlen(name) != 1) return key;  // no letter, or not a Latin one
  const auto letter = static_cast<unsigned char>(name[0]);
  return std::isalnum(letter) != 0 ? std::toupper(letter) : key;
}

}  // namespace

struct Window::State {
  GLFWwindow* window = nullptr;
  GlErrorLog errors;
  WindowEventLog log;
  bool damaged = false;  // the window must be painted again
  // The picture last shown; null before the first.
  struct Surface {
    GlTexture texture;
    GlFramebuffer framebuffer;
  };
  std::unique_ptr<Surface> surface;
  std::optional<Panel> panel;
  std::vector<WindowEvent> events;  // returned by the last call of events()

  State() = default;
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    if (window == nullptr) return;
    glfwMakeContextCurrent(window);
    surface.reset();
    panel.reset();
    glfwDestroyWindow(window);
    if (--open_windows == 0) glfwTerminate();
  }

  static int open_windows;  // GLFW is terminated with the last one

  static State& of(GLFWwindow* window) {
    return *static_cast<State*>(glfwGetWindowUserPointer(window));
  }

  // Paints the picture last shown.
  void paint();
  // Passes the gathered events to the panel, and puts those that are not the panel's into `events`.
  void take_events();
  void fit_panel();
  void set_callbacks();
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
  glfwSetWindowUserPointer(window, state.get());
  glfwMakeContextCurrent(window);
  glfwSwapInterval(1);
  state->errors.attach();

  int window_width = 0, window_height = 0;  // a window manager may have changed them
  glfwGetWindowSize(window, &window_width, &window_height);
  state->log.shows(width, height);
  state->log.resized(window_width, window_height);
  state->set_callbacks();
  return Window(std::move(state));
}

void Window::State::set_callbacks() {
  glfwSetWindowSizeCallback(
      window, [](GLFWwindow* w, int width, int height) { of(w).log.resized(width, height); });
  glfwSetFramebufferSizeCallback(
      window, [](GLFWwindow* w, int /*width*/, int /*height*/) { of(w).damaged = true; });
  glfwSetWindowRefreshCallback(window, [](GLFWwindow* w) { of(w).damaged = true; });
  glfwSetCursorPosCallback(window,
                           [](GLFWwindow* w, double x, double y) { of(w).log.moved(x, y); });
  glfwSetMouseButtonCallback(window, [](GLFWwindow* w, int button, int action, int /*mods*/) {
    of(w).log.button(button, action == GLFW_PRESS);
  });
  glfwSetScrollCallback(window, [](GLFWwindow* w, double /*x*/, double y) {
    if (y != 0) of(w).log.wheel(y);
  });
  glfwSetKeyCallback(window, [](GLFWwindow* w, int key, int scancode, int action, int mods) {
    if (action != GLFW_PRESS) return;
    if ((mods & (GLFW_MOD_CONTROL | GLFW_MOD_ALT | GLFW_MOD_SUPER)) != 0) return;
    of(w).log.key(layout_key(key, scancode));
  });
  static_assert(WindowEvent::kEscape == GLFW_KEY_ESCAPE);
  // Else a press before the first motion would have the position (0, 0).
  double x = 0, y = 0;
  glfwGetCursorPos(window, &x, &y);
  log.moved(x, y);
}

void Window::State::paint() {
  damaged = false;
  int width = 0, height = 0;
  glfwGetFramebufferSize(window, &width, &height);
  const GlTexture& picture = surface->texture;
  const auto at = place_picture(picture.width(), picture.height(), width, height);
  if (!at) return;  // minimised: painted when it is shown again
  glDisable(GL_SCISSOR_TEST);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
  if (at->width != width || at->height != height) {
    glClearColor(0, 0, 0, 1);
    glClear(GL_COLOR_BUFFER_BIT);
  }
  // Row 0 of the picture is at the top, row 0 of the window at the bottom.
  glBlitNamedFramebuffer(surface->framebuffer.get(), 0, 0, 0, picture.width(), picture.height(),
                         at->x, at->y + at->height, at->x + at->width, at->y, GL_COLOR_BUFFER_BIT,
                         at->width == picture.width() ? GL_NEAREST : GL_LINEAR);
  if (panel) panel->draw(width, height);
  glfwSwapBuffers(window);
}

void Window::State::fit_panel() {
  int width = 0, height = 0;
  glfwGetWindowSize(window, &width, &height);
  panel->resize(width, height);
}

void Window::State::take_events() {
  const std::span<const WindowEvent> all = log.take();
  events.clear();
  bool on_panel = false;
  for (std::size_t i = 0; i < all.size(); ++i) {
    // A mouse may report a thousand moves per second; only the last of consecutive ones is handled.
    const bool counts = i + 1 == all.size() || all[i].kind != WindowEvent::Kind::kMove ||
                        all[i + 1].kind != WindowEvent::Kind::kMove;
    if (panel && counts) on_panel = panel->handle(all[i]);
    if (!on_panel || all[i].kind == WindowEvent::Kind::kKey) events.push_back(all[i]);
  }
  if (panel && !all.empty()) damaged |= panel->changed();
}

Window::Window(std::unique_ptr<State> state) : state_(std::move(state)) {}
Window::Window(Window&&) noexcept = default;
Window& Window::operator=(Window&&) noexcept = default;
Window::~Window() = default;

void Window::set_panel(Panel::Layout layout) {
  state_->panel.reset();
  if (layout == nullptr) return;
  state_->panel = value_or_throw(Panel::make(std::move(layout)));
  state_->fit_panel();
}

void Window::show(const ColorImage& picture) {
  PALPABLE_EXPECT(!picture.empty(), "a picture has pixels");
  State& s = *state_;
  s.log.shows(picture.width(), picture.height());
  if (!s.surface || s.surface->texture.width() != picture.width() ||
      s.surface->texture.height() != picture.height()) {
    s.surface = std::make_unique<State::Surface>();
    s.surface->texture = GlTexture(GL_RGBA8, picture.width(), picture.height());
    s.surface->framebuffer =
        GlFramebuffer(std::array<const GlTexture*, 1>{&s.surface->texture}, nullptr);
  }
  s.surface->texture.upload(0, 0, picture.width(), picture.height(), GL_RGB, GL_UNSIGNED_BYTE,
                            picture.data());
  if (s.panel) s.panel->lay_out();
  s.paint();
}

std::span<const WindowEvent> Window::events(double wait) {
  State& s = *state_;
  if (wait > 0 && s.log.empty() && !s.damaged) {
    glfwWaitEventsTimeout(wait);
  } else {
    glfwPollEvents();
  }
  // Once for all reports of a resize by the mouse, which come faster than pictures can be painted.
  if (s.damaged && s.surface) {
    if (s.panel) s.fit_panel();
    s.paint();
  }
  s.take_events();
  return s.events;
}

bool Window::closed() const { return glfwWindowShouldClose(state_->window) == GLFW_TRUE; }

void Window::make_current() { glfwMakeContextCurrent(state_->window); }

const GlErrorLog& Window::gl_errors() const { return state_->errors; }

}  // namespace palpable

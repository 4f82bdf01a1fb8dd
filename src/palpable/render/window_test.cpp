#include "palpable/render/window.h"

#include "palpable/render/gl_objects.h"
#include "palpable/render/orbit_camera.h"
#include "tests/support/foreign_leaks.h"
#include "tests/support/test.h"

#include <X11/Xlib.h>
#include <X11/Xutil.h>
#include <X11/keysym.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

using namespace palpable;

namespace {

/// An X server of the test's own, without a screen (Xvfb), or the reason why there is none.
class VirtualScreen {
 public:
  VirtualScreen() {
    std::array<int, 2> pipe_ends{};
    if (::pipe(pipe_ends.data()) != 0) return;
    child_ = ::fork();
    if (child_ == 0) {
      ::close(pipe_ends[0]);
      // Xvfb picks a free number and writes it when it is ready.
      const std::string fd = std::to_string(pipe_ends[1]);
      if (std::freopen("/dev/null", "w", stderr) == nullptr) ::_exit(127);
      ::execlp("Xvfb", "Xvfb", "-displayfd", fd.c_str(), "-screen", "0", "800x600x24", "-nolisten",
               "tcp", nullptr);
      ::_exit(127);
    }
    ::close(pipe_ends[1]);
    // Up to the end of the line: Xvfb would not survive a pipe that is closed earlier.
    std::string number;
    for (char c = 0; ::read(pipe_ends[0], &c, 1) == 1 && c != '\n';) number += c;
    ::close(pipe_ends[0]);
    if (number.empty()) return;
    name_.push_back(':');
    name_ += number;
    ::setenv("DISPLAY", name_.c_str(), 1);
  }
  ~VirtualScreen() {
    ::unsetenv("DISPLAY");
    if (child_ > 0) {
      ::kill(child_, SIGTERM);
      ::waitpid(child_, nullptr, 0);
    }
  }
  VirtualScreen(const VirtualScreen&) = delete;
  VirtualScreen& operator=(const VirtualScreen&) = delete;
  [[nodiscard]] bool ready() const { return !name_.empty(); }
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  pid_t child_ = -1;
  std::string name_;
};

}  // namespace

TEST_CASE("a window shows a picture upright and hands on what the mouse and the keys do",
          "[render][window]") {
  const VirtualScreen screen;
  if (!screen.ready()) PALPABLE_SKIP("no Xvfb (Debian package xvfb)");
  const test::IgnoreForeignLeaks ignore;
  Result<palpable::Window> opened = palpable::Window::open("test", 320, 200);
  if (!opened.ok()) PALPABLE_SKIP(opened.problem().message);
  palpable::Window& window = opened.value();
  CHECK_FALSE(window.closed());

  ColorImage picture(320, 200, {10, 20, 30});
  for (int y = 0; y < 50; ++y) std::fill_n(picture.row(y), 80, Rgb{200, 100, 50});
  window.show(picture);
  window.show(picture);

  // What the X server itself has on its screen.
  Display* x = XOpenDisplay(screen.name().c_str());
  REQUIRE(x != nullptr);
  ::Window root = DefaultRootWindow(x), parent = 0, *children = nullptr;
  unsigned count = 0;
  REQUIRE(XQueryTree(x, root, &root, &parent, &children, &count) != 0);
  ::Window ours = 0;
  for (unsigned i = 0; i < count; ++i) {
    XWindowAttributes is{};
    XGetWindowAttributes(x, children[i], &is);
    if (is.width == 320 && is.height == 200) ours = children[i];
  }
  REQUIRE(ours != 0);
  XFree(children);
  XImage* seen = XGetImage(x, ours, 0, 0, 320, 200, AllPlanes, ZPixmap);
  REQUIRE(seen != nullptr);
  CHECK((XGetPixel(seen, 10, 10) & 0xffffff) == 0xc86432);
  CHECK((XGetPixel(seen, 79, 49) & 0xffffff) == 0xc86432);
  CHECK((XGetPixel(seen, 80, 50) & 0xffffff) == 0x0a141e);
  CHECK((XGetPixel(seen, 10, 190) & 0xffffff) == 0x0a141e);
  XDestroyImage(seen);

  // What a user would do, sent as an X server sends it.
  const auto send = [&](int type, unsigned button, int px, int py) {
    XEvent event{};
    event.xbutton.type = type;
    event.xbutton.display = x;
    event.xbutton.window = ours;
    event.xbutton.root = root;
    event.xbutton.x = px;
    event.xbutton.y = py;
    event.xbutton.button = button;
    event.xbutton.same_screen = True;
    XSendEvent(x, ours, True, NoEventMask, &event);
  };
  XWarpPointer(x, None, ours, 0, 0, 0, 0, 40, 30);
  XSync(x, False);
  send(ButtonPress, 1, 40, 30);
  send(ButtonRelease, 1, 40, 30);
  send(ButtonPress, 4, 40, 30);  // the wheel, away from the user
  XEvent key{};
  key.xkey.type = KeyPress;
  key.xkey.display = x;
  key.xkey.window = ours;
  key.xkey.root = root;
  key.xkey.keycode = XKeysymToKeycode(x, XK_Escape);
  key.xkey.same_screen = True;
  XSendEvent(x, ours, True, NoEventMask, &key);
  XSync(x, False);

  std::vector<WindowEvent> all;
  const auto has = [&](WindowEvent::Kind kind) {
    return std::find_if(all.begin(), all.end(),
                        [&](const WindowEvent& event) { return event.kind == kind; });
  };
  for (int i = 0; i < 200 && has(WindowEvent::Kind::kKey) == all.end(); ++i) {
    const auto events = window.events(0.05);
    all.insert(all.end(), events.begin(), events.end());
  }
  const auto press = has(WindowEvent::Kind::kPress), release = has(WindowEvent::Kind::kRelease);
  const auto wheel = has(WindowEvent::Kind::kWheel), typed = has(WindowEvent::Kind::kKey);
  REQUIRE(press != all.end());
  CHECK(press->button == 0);
  CHECK(press->x_px == Approx(39.5));
  CHECK(press->y_px == Approx(29.5));
  CHECK(release != all.end());
  REQUIRE(wheel != all.end());
  CHECK(wheel->wheel == 1.0);
  REQUIRE(typed != all.end());
  CHECK(typed->key == WindowEvent::kEscape);
  XCloseDisplay(x);
  INFO(window.gl_errors().first());
  CHECK(window.gl_errors().count() == 0);
}

TEST_CASE("without a display there is no window but a reason", "[render][window]") {
  const char* display = std::getenv("DISPLAY");
  const std::string kept = display != nullptr ? display : "";
  ::unsetenv("DISPLAY");
  const Result<palpable::Window> opened = palpable::Window::open("test", 320, 200);
  if (!kept.empty()) ::setenv("DISPLAY", kept.c_str(), 1);
  REQUIRE_FALSE(opened.ok());
  CHECK(opened.problem().message.find("cannot open a window") == 0);
  CHECK(opened.problem().message.find("DISPLAY") != std::string::npos);
}

#include "palpable/live/render/window.h"

#include "palpable/live/render/gl_objects.h"
#include "palpable/live/render/orbit_camera.h"
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
#include <imgui.h>
#include <iterator>
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
      ::execlp("Xvfb", "Xvfb", "-displayfd", fd.c_str(), "-screen", "0", "1300x900x24", "-nolisten",
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

/// A user at that screen: reads the pixels of a window and sends it events of mouse and keyboard.
class User {
 public:
  /// @param width, height  of the window to be used
  User(const VirtualScreen& screen, int width, int height)
      : x_(XOpenDisplay(screen.name().c_str())) {
    REQUIRE(x_ != nullptr);
    root_ = DefaultRootWindow(x_);
    ::Window parent = 0, *children = nullptr;
    unsigned count = 0;
    REQUIRE(XQueryTree(x_, root_, &root_, &parent, &children, &count) != 0);
    for (unsigned i = 0; i < count; ++i) {
      XWindowAttributes is{};
      XGetWindowAttributes(x_, children[i], &is);
      if (is.width == width && is.height == height) window_ = children[i];
    }
    XFree(children);
    REQUIRE(window_ != 0);
  }
  ~User() { XCloseDisplay(x_); }
  User(const User&) = delete;
  User& operator=(const User&) = delete;

  /// The colour (0xrrggbb) at each of the positions.
  std::vector<unsigned long> pixels(const std::vector<std::array<int, 2>>& places) {
    XWindowAttributes is{};
    XGetWindowAttributes(x_, window_, &is);
    XImage* seen = XGetImage(x_, window_, 0, 0, static_cast<unsigned>(is.width),
                             static_cast<unsigned>(is.height), AllPlanes, ZPixmap);
    REQUIRE(seen != nullptr);
    std::vector<unsigned long> colors;
    for (const auto [px, py] : places) colors.push_back(XGetPixel(seen, px, py) & 0xffffff);
    XDestroyImage(seen);
    return colors;
  }

  void point_at(int px, int py) {
    XWarpPointer(x_, None, window_, 0, 0, 0, 0, px, py);
    XSync(x_, False);
  }
  /// A button of X: 1 left, 3 right, 4 the wheel away from the user.
  void button(bool down, unsigned button, int px, int py) {
    XEvent event{};
    event.xbutton.type = down ? ButtonPress : ButtonRelease;
    event.xbutton.root = root_;
    event.xbutton.x = px;
    event.xbutton.y = py;
    event.xbutton.button = button;
    event.xbutton.same_screen = True;
    send(event);
  }
  void move(int px, int py) {
    XEvent event{};
    event.xmotion.type = MotionNotify;
    event.xmotion.root = root_;
    event.xmotion.x = px;
    event.xmotion.y = py;
    event.xmotion.same_screen = True;
    send(event);
  }
  void type(KeySym key, unsigned modifiers = 0) { type_at(XKeysymToKeycode(x_, key), modifiers); }
  /// @param place  number of a key on the keyboard, independent of its name
  void type_at(KeyCode place, unsigned modifiers = 0) {
    XEvent event{};
    event.xkey.type = KeyPress;
    event.xkey.root = root_;
    event.xkey.keycode = place;
    event.xkey.state = modifiers;
    event.xkey.same_screen = True;
    send(event);
  }
  /// Changes the key that types `from` so that it types `to`. @return its number
  KeyCode rename_key(KeySym from, KeySym to) {
    const KeyCode place = XKeysymToKeycode(x_, from);
    XChangeKeyboardMapping(x_, place, 1, &to, 1);
    XSync(x_, False);
    return place;
  }
  void resize(int width, int height) {
    XResizeWindow(x_, window_, static_cast<unsigned>(width), static_cast<unsigned>(height));
    XSync(x_, False);
  }
  void unmap() {
    XUnmapWindow(x_, window_);
    XSync(x_, False);
  }
  void map() {
    XMapWindow(x_, window_);
    XSync(x_, False);
  }
  void focus(bool here) {
    XSetInputFocus(x_, here ? window_ : root_, RevertToNone, CurrentTime);
    XSync(x_, False);
  }
  /// Sends the message of a window manager when the user closes a window.
  void ask_to_close() {
    XEvent event{};
    event.xclient.type = ClientMessage;
    event.xclient.message_type = XInternAtom(x_, "WM_PROTOCOLS", False);
    event.xclient.format = 32;
    event.xclient.data.l[0] = static_cast<long>(XInternAtom(x_, "WM_DELETE_WINDOW", False));
    send(event);
  }

 private:
  void send(XEvent& event) {
    event.xany.display = x_;
    event.xany.window = window_;
    XSendEvent(x_, window_, True, NoEventMask, &event);
    XSync(x_, False);
  }

  Display* x_;
  ::Window root_ = 0, window_ = 0;
};

// A picture whose upper left corner (a quarter of its width and height) has the colour 0xc86432.
ColorImage marked_picture() {
  ColorImage picture(320, 200, {10, 20, 30});
  for (int y = 0; y < 50; ++y) std::fill_n(picture.row(y), 80, Rgb{200, 100, 50});
  return picture;
}
constexpr unsigned long kMark = 0xc86432, kRest = 0x0a141e, kBorder = 0, kPanel = 0x12171c;

// The events of the window until one of that kind has arrived, or for 10 s.
std::vector<WindowEvent> events_until(palpable::Window& window, WindowEvent::Kind kind) {
  std::vector<WindowEvent> all;
  const auto there = [&](const WindowEvent& event) { return event.kind == kind; };
  for (int i = 0; i < 200 && std::none_of(all.begin(), all.end(), there); ++i) {
    const auto events = window.events(0.05);
    all.insert(all.end(), events.begin(), events.end());
  }
  return all;
}

// The events of one kind.
std::vector<WindowEvent> only(WindowEvent::Kind kind, const std::vector<WindowEvent>& all) {
  std::vector<WindowEvent> some;
  std::copy_if(all.begin(), all.end(), std::back_inserter(some),
               [&](const WindowEvent& event) { return event.kind == kind; });
  return some;
}

// The pixels that the user sees, once they are `expected`, or after 10 s. Shows no new picture.
std::vector<unsigned long> pixels_after_events(palpable::Window& window, User& user,
                                               const std::vector<std::array<int, 2>>& places,
                                               const std::vector<unsigned long>& expected) {
  std::vector<unsigned long> seen;
  for (int i = 0; i < 200 && seen != expected; ++i) {
    static_cast<void>(window.events(0.05));
    seen = user.pixels(places);
  }
  return seen;
}

using Kind = WindowEvent::Kind;

}  // namespace

// Opens `window` with the marked picture on the screen of `user`, or skips the test.
#define WINDOW_WITH_PICTURE(window, user)                                     \
  const VirtualScreen screen;                                                 \
  if (!screen.ready()) PALPABLE_SKIP("no Xvfb (Debian package xvfb)");        \
  const test::IgnoreForeignLeaks ignore;                                      \
  Result<palpable::Window> opened = palpable::Window::open("test", 320, 200); \
  if (!opened.ok()) PALPABLE_SKIP(opened.problem().message);                  \
  palpable::Window& window = opened.value();                                  \
  window.show(marked_picture());                                              \
  window.show(marked_picture());                                              \
  User user(screen, 320, 200)

TEST_CASE("a window shows a picture upright and hands on what the mouse and the keys do",
          "[render][window]") {
  WINDOW_WITH_PICTURE(window, user);
  CHECK_FALSE(window.closed());
  CHECK(user.pixels({{10, 10}, {79, 49}, {80, 50}, {10, 190}}) ==
        std::vector{kMark, kMark, kRest, kRest});

  user.point_at(40, 30);
  user.button(true, 1, 40, 30);
  user.button(false, 1, 40, 30);
  user.button(true, 4, 40, 30);
  user.type(XK_Escape);
  const std::vector<WindowEvent> all = events_until(window, Kind::kKey);
  const auto press = only(Kind::kPress, all), release = only(Kind::kRelease, all);
  const auto wheel = only(Kind::kWheel, all), typed = only(Kind::kKey, all);
  REQUIRE(press.size() == 1);
  CHECK(press[0].button == 0);
  CHECK(press[0].x_px == Approx(39.5));
  CHECK(press[0].y_px == Approx(29.5));
  CHECK(release.size() == 1);
  REQUIRE(wheel.size() == 1);
  CHECK(wheel[0].wheel == 1.0);
  REQUIRE(typed.size() == 1);
  CHECK(typed[0].key == WindowEvent::kEscape);
  user.ask_to_close();
  for (int i = 0; i < 200 && !window.closed(); ++i) static_cast<void>(window.events(0.05));
  CHECK(window.closed());
  INFO(window.gl_errors().first());
  CHECK(window.gl_errors().count() == 0);
}

TEST_CASE("a window that is resized or uncovered shows its picture again by itself",
          "[render][window]") {
  WINDOW_WITH_PICTURE(window, user);
  user.resize(640, 500);  // the picture from 0, 50 to 640, 450
  const std::vector<std::array<int, 2>> larger{{20, 60},   {150, 140}, {170, 160},
                                               {600, 440}, {20, 20},   {600, 480}};
  const std::vector<unsigned long> expected{kMark, kMark, kRest, kRest, kBorder, kBorder};
  CHECK(pixels_after_events(window, user, larger, expected) == expected);
  user.unmap();  // as a window manager does to minimise a window
  static_cast<void>(window.events(0.05));
  user.map();
  CHECK(pixels_after_events(window, user, larger, expected) == expected);
  user.resize(160, 100);
  const std::vector<std::array<int, 2>> smaller{{5, 5}, {35, 20}, {45, 30}, {150, 95}};
  const std::vector<unsigned long> all{kMark, kMark, kRest, kRest};
  CHECK(pixels_after_events(window, user, smaller, all) == all);
  user.point_at(80, 50);  // positions are still those of the picture
  user.button(true, 1, 80, 50);
  const auto press = only(Kind::kPress, events_until(window, Kind::kPress));
  REQUIRE(press.size() == 1);
  CHECK(press[0].x_px == Approx(159.5));
  CHECK(press[0].y_px == Approx(99.5));
  INFO(window.gl_errors().first());
  CHECK(window.gl_errors().count() == 0);
}

TEST_CASE("a press and a drag that are over before the next frame are where they happened",
          "[render][window]") {
  WINDOW_WITH_PICTURE(window, user);
  user.point_at(300, 190);  // the pointer's position when the events are read
  user.move(40, 30);
  user.button(true, 1, 40, 30);
  user.move(240, 130);
  user.button(false, 1, 240, 130);
  const std::vector<WindowEvent> all = events_until(window, Kind::kRelease);
  const auto press = only(Kind::kPress, all), release = only(Kind::kRelease, all);
  REQUIRE(press.size() == 1);
  CHECK(press[0].x_px == Approx(39.5));
  CHECK(press[0].y_px == Approx(29.5));
  REQUIRE(release.size() == 1);
  CHECK(release[0].x_px == Approx(239.5));
  CHECK(release[0].y_px == Approx(129.5));
}

TEST_CASE("a window that loses the keyboard during a press reports the button as released",
          "[render][window]") {
  WINDOW_WITH_PICTURE(window, user);
  user.focus(true);
  user.point_at(40, 30);
  user.button(true, 1, 40, 30);
  REQUIRE(only(Kind::kPress, events_until(window, Kind::kPress)).size() == 1);
  user.focus(false);
  CHECK(only(Kind::kRelease, events_until(window, Kind::kRelease)).size() == 1);
}

TEST_CASE("a key counts once, by the name that the user's keyboard gives it, and not with Ctrl",
          "[render][window]") {
  WINDOW_WITH_PICTURE(window, user);
  const KeyCode place = user.rename_key(XK_h, XK_p);
  user.type(XK_s, ControlMask);
  user.type_at(place);
  user.type_at(place);  // held down: the keyboard repeats it
  user.type(XK_Escape);
  std::vector<int> keys;
  for (int i = 0; i < 200 && (keys.empty() || keys.back() != WindowEvent::kEscape); ++i) {
    for (const WindowEvent& event : window.events(0.05)) {
      if (event.kind == Kind::kKey) keys.push_back(event.key);
    }
  }
  CHECK(keys == std::vector<int>{'P', WindowEvent::kEscape});
}

TEST_CASE("what the mouse does on a panel is the panel's alone, and keys are the program's",
          "[render][window][panel]") {
  WINDOW_WITH_PICTURE(window, user);
  bool checked = false;
  ImVec2 box;  // the check box's middle
  window.set_panel([&] {
    ImGui::SetNextWindowPos({0, 0});
    ImGui::SetNextWindowSize({100, 60});
    ImGui::Begin("panel", nullptr, ImGuiWindowFlags_NoDecoration);
    ImGui::Checkbox("box", &checked);
    const ImVec2 least = ImGui::GetItemRectMin(), most = ImGui::GetItemRectMax();
    box = {0.5f * (least.x + most.x), 0.5f * (least.y + most.y)};
    ImGui::End();
  });
  ColorImage picture = marked_picture();
  window.show(picture);
  window.show(picture);
  CHECK(user.pixels({{98, 58}, {10, 190}}) == std::vector{kPanel, kRest});
  CHECK(picture == marked_picture());

  // On the panel: a click that ends before the next frame.
  const int x = static_cast<int>(box.x), y = static_cast<int>(box.y);
  user.point_at(200, 150);
  user.move(x, y);
  user.button(true, 1, x, y);
  user.button(false, 1, x, y);
  user.type(XK_k);
  std::vector<WindowEvent> all = events_until(window, Kind::kKey);
  CHECK(checked);
  CHECK(only(Kind::kPress, all).empty());
  CHECK(only(Kind::kRelease, all).empty());
  CHECK(only(Kind::kKey, all).size() == 1);

  // Beside the panel, and a drag that ends on it.
  user.move(200, 150);
  user.button(true, 1, 200, 150);
  user.move(x, y);
  user.button(false, 1, x, y);
  all = events_until(window, Kind::kRelease);
  CHECK(only(Kind::kPress, all).size() == 1);
  CHECK(only(Kind::kRelease, all).size() == 1);
  CHECK(checked);  // still
  INFO(window.gl_errors().first());
  CHECK(window.gl_errors().count() == 0);
}

TEST_CASE("a panel shows what was clicked without a new picture, and grows with its window",
          "[render][window][panel]") {
  WINDOW_WITH_PICTURE(window, user);
  bool shown = true;
  float letters = 0;
  window.set_panel([&] {
    letters = ImGui::GetFontSize();
    if (!shown) return;
    ImGui::SetNextWindowPos({0, 0});
    ImGui::SetNextWindowSize({60, 60});
    ImGui::Begin("panel", nullptr, ImGuiWindowFlags_NoDecoration);
    if (ImGui::Button("##hide", {50, 50})) shown = false;
    ImGui::End();
  });
  window.show(marked_picture());
  CHECK(user.pixels({{58, 58}}) == std::vector{kPanel});
  user.move(30, 30);
  user.button(true, 1, 30, 30);
  user.button(false, 1, 30, 30);
  const std::vector<std::array<int, 2>> places{{30, 30}, {58, 58}};
  const std::vector<unsigned long> without{kMark, kRest};
  CHECK(pixels_after_events(window, user, places, without) == without);
  CHECK_FALSE(shown);
  const float small = letters;
  user.resize(1300, 900);
  const std::vector<unsigned long> border{kBorder};
  CHECK(pixels_after_events(window, user, {{10, 10}}, border) == border);
  CHECK(letters > small);
  CHECK(panel_letters(1280, 720) == 15);
  CHECK(panel_letters(3840, 2160) == 42);
  CHECK(panel_letters(500, 2160) == 10);
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

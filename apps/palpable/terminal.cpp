#include "apps/palpable/terminal.h"

#include "apps/common/command_line.h"
#include "apps/common/printing.h"
#include "apps/common/progress_bar.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/output_file.h"
#include "palpable/live/render/picture_file.h"

#include <fmt/core.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;

std::atomic<bool> interrupted = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may set it");

}  // namespace

void listen_for_ctrl_c() {
  for (const int signal : {SIGINT, SIGTERM}) {
    std::signal(signal, [](int which) {
      interrupted = true;
      std::signal(which, SIG_DFL);
    });
  }
  if (std::signal(SIGHUP, [](int) { interrupted = true; }) == SIG_IGN) {
    std::signal(SIGHUP, SIG_IGN);
  }
}

bool asked_to_end() { return interrupted; }

bool has_screen() {
  const char* x11 = std::getenv("DISPLAY");
  const char* wayland = std::getenv("WAYLAND_DISPLAY");
  return (x11 != nullptr && *x11 != '\0') || (wayland != nullptr && *wayland != '\0');
}

std::string keep_picture(const fs::path& body, const std::string& what, const ColorImage& picture) {
  try {
    const auto name = [&](int n) {
      return fmt::format("{}_{}_{}.png", body.stem().string(), what, n);
    };
    int n = 1;
    std::error_code ignored;
    while (fs::exists(name(n), ignored)) ++n;
    guard_output_file(name(n), {body});
    write_png(name(n), picture);
    print_text("{}\n", name(n));
    std::fflush(stdout);  // at once also for a pipe: the window may stay open for long
    return name(n);
  } catch (const Error& error) {
    print_error(error.what());
    return error.what();
  }
}

PlayUser user_at(ProgressBar& bar) {
  return {.print =
              [](const std::string& text) {
                print_text("{}", text);
                std::fflush(stdout);  // at once also for a pipe
              },
          .say = [&bar](const std::string& line) { bar.say(line); },
          .progress = bar.progress(),
          .begin = listen_for_ctrl_c,
          .asked_to_end = asked_to_end,
          .keep_picture =
              [](const fs::path& body, const ColorImage& picture) {
                return keep_picture(body, "live", picture);
              }};
}

}  // namespace palpable::app

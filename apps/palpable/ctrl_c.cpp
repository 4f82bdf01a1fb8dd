#include "apps/palpable/ctrl_c.h"

#include <atomic>
#include <csignal>

namespace palpable::app {
namespace {

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

}  // namespace palpable::app

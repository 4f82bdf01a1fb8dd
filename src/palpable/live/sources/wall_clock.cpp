#include "palpable/live/sources/wall_clock.h"

#include <chrono>
#include <thread>

namespace palpable {
namespace {

class SystemClock final : public WallClock {
 public:
  double now() override {
    const auto since = std::chrono::steady_clock::now().time_since_epoch();
    return std::chrono::duration<double>(since).count();
  }
  void sleep(double seconds) override {
    std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
  }
};

}  // namespace

WallClock& system_clock() {
  static SystemClock clock;
  return clock;
}

}  // namespace palpable

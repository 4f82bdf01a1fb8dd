#include "palpable/bake/campaign/crew.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <thread>

namespace palpable {

int LocalCrew::threads(int wanted) const {
  if (wanted > 0) return wanted;
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

void LocalCrew::share(int count, const std::function<void(const Pieces&)>& run,
                      const std::function<void(int, int)>& finished) {
  std::atomic<int> next{0};
  std::mutex finishing;
  run({[&]() -> std::optional<int> {
         const int i = next++;
         return i < count ? std::optional(i) : std::nullopt;
       },
       [&](int piece, int result) {
         const std::lock_guard lock(finishing);
         finished(piece, result);
       }});
}

}  // namespace palpable

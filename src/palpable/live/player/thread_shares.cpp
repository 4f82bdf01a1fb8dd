#include "palpable/live/player/thread_shares.h"

#include "palpable/common/base/contract.h"

#include <algorithm>
#include <sched.h>
#include <thread>

namespace palpable {

ThreadShares thread_shares(int threads) {
  PALPABLE_EXPECT(threads >= 1, "a run has a thread");
  // The matcher has 8 strips; the renderer has 16 tiles across the picture.
  constexpr int kMostMatching = 8, kMostDrawing = 8;
  if (threads == 1) return {};
  return {.matching = std::min(threads, kMostMatching),
          .images = std::max(1, threads / 2),
          .drawing = std::min(threads / 2, kMostDrawing)};
}

int usual_threads() {
  cpu_set_t set;
  if (sched_getaffinity(0, sizeof set, &set) == 0) return std::max(1, CPU_COUNT(&set));
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

}  // namespace palpable

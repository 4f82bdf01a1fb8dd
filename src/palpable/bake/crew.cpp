#include "palpable/bake/crew.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>

namespace palpable {

int LocalCrew::threads(int wanted) const {
  if (wanted > 0) return wanted;
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

void LocalCrew::share(int count, int threads, const std::function<int(int)>& work,
                      const std::function<void(int, int)>& finished) {
  std::atomic<int> next{0};
  std::atomic<bool> failed{false};
  std::mutex telling;
  std::vector<std::exception_ptr> problems(static_cast<std::size_t>(count));
  const auto run = [&] {
    for (int i = next++; i < count && !failed; i = next++) {
      try {
        const int answer = work(i);
        const std::lock_guard lock(telling);
        finished(i, answer);
      } catch (...) {
        problems[static_cast<std::size_t>(i)] = std::current_exception();
        failed = true;
      }
    }
  };
  std::vector<std::thread> others;
  for (int t = 1; t < std::min(threads, count); ++t) others.emplace_back(run);
  run();
  for (std::thread& thread : others) thread.join();
  for (const std::exception_ptr& problem : problems) {
    if (problem) std::rethrow_exception(problem);
  }
}

}  // namespace palpable

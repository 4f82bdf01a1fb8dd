#include "palpable/common/base/parallel_work.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace palpable {

void work_in_parallel(int count, int threads, const std::string& task, const Progress& progress,
                      const std::function<void(int item)>& work) {
  std::atomic<int> next{0};
  std::mutex mutex;
  int done = 0;
  std::exception_ptr failure;
  const auto run = [&] {
    for (int item = next++; item < count; item = next++) {
      try {
        work(item);
        const std::scoped_lock lock(mutex);
        ++done;
        report(progress, {task, static_cast<double>(done), static_cast<double>(count), ""});
      } catch (...) {
        const std::scoped_lock lock(mutex);
        if (!failure) failure = std::current_exception();
        next = count;
        return;
      }
    }
  };
  std::vector<std::thread> others;
  for (int t = 1; t < std::min(threads, count); ++t) others.emplace_back(run);
  run();
  for (std::thread& thread : others) thread.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace palpable

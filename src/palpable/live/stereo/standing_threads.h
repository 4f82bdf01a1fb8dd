/// @file
/// A small thread pool for parallel loops that take milliseconds in every frame.
#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

namespace palpable {

/// Consists of the caller's thread and size - 1 more. Does not allocate after its construction.
class StandingThreads {
 public:
  /// @param size  >= 1
  explicit StandingThreads(int size);
  StandingThreads(const StandingThreads&) = delete;
  StandingThreads& operator=(const StandingThreads&) = delete;
  ~StandingThreads();

  [[nodiscard]] int size() const { return static_cast<int>(threads_.size()) + 1; }

  /// Calls work(i) once for each i in [0, count), distributed over all threads, and returns when
  /// all calls have returned. `work` must not throw.
  template <class Work>
  void run(int count, const Work& work) {
    run(count, &work, [](const void* w, int i) { (*static_cast<const Work*>(w))(i); });
  }

 private:
  using Call = void (*)(const void*, int);
  void run(int count, const void* work, Call call);
  void work_until_end();
  void work_on_pieces(std::unique_lock<std::mutex>& lock);

  std::vector<std::thread> threads_;
  std::mutex mutex_;
  std::condition_variable begun_;
  std::condition_variable done_;
  const void* work_ = nullptr;
  Call call_ = nullptr;
  int next_ = 0;
  int count_ = 0;
  int unfinished_ = 0;
  bool ends_ = false;
};

}  // namespace palpable

#include "palpable/live/stereo/standing_threads.h"

#include "palpable/common/base/contract.h"

namespace palpable {

StandingThreads::StandingThreads(int size) {
  PALPABLE_EXPECT(size >= 1 && size <= 64, "there are 1 to 64 threads");
  for (int i = 1; i < size; ++i) threads_.emplace_back([this] { work_until_end(); });
}

StandingThreads::~StandingThreads() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  begun_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void StandingThreads::run(int count, const void* work, Call call) {
  if (threads_.empty()) {
    for (int i = 0; i < count; ++i) call(work, i);
    return;
  }
  std::unique_lock lock(mutex_);
  work_ = work;
  call_ = call;
  next_ = 0;
  count_ = unfinished_ = count;
  begun_.notify_all();
  work_on_pieces(lock);
  done_.wait(lock, [this] { return unfinished_ == 0; });
}

void StandingThreads::work_on_pieces(std::unique_lock<std::mutex>& lock) {
  while (next_ < count_) {
    const int mine = next_++;
    lock.unlock();
    call_(work_, mine);
    lock.lock();
    if (--unfinished_ == 0) done_.notify_all();
  }
}

void StandingThreads::work_until_end() {
  std::unique_lock lock(mutex_);
  while (true) {
    begun_.wait(lock, [this] { return ends_ || next_ < count_; });
    if (ends_) return;
    work_on_pieces(lock);
  }
}

}  // namespace palpable

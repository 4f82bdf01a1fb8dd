/// @file
/// Hands work from one thread to another, and waits when the other does not keep up.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

namespace palpable {

/// First in, first out. Any number of threads may push and pop. Allocates when it is made, and
/// never again.
template <class T>
class BoundedQueue {
 public:
  /// @param capacity  items, at least one
  explicit BoundedQueue(std::size_t capacity) : ring_(capacity) {}

  /// Waits for room. False, and the item is dropped, once the queue is closed.
  bool push(T item) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return closed_ || count_ < ring_.size(); });
    if (closed_) return false;
    ring_[(first_ + count_) % ring_.size()] = std::move(item);
    ++count_;
    changed_.notify_all();
    return true;
  }

  /// Waits for an item; nothing once the queue is closed and empty.
  std::optional<T> pop() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return closed_ || count_ > 0; });
    return pop_first();
  }

  /// The same, but waits at most so long: nothing then, too. drained() tells the two apart.
  std::optional<T> pop_within(std::chrono::duration<double> wait) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, wait, [this] { return closed_ || count_ > 0; });
    return pop_first();
  }

  /// Whether the queue is closed and empty: pop() will never give an item again.
  [[nodiscard]] bool drained() {
    const std::lock_guard lock(mutex_);
    return closed_ && count_ == 0;
  }

  [[nodiscard]] bool closed() {
    const std::lock_guard lock(mutex_);
    return closed_;
  }

  /// Refuses further items. Those in the queue can still be popped.
  void close() {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    changed_.notify_all();
  }

 private:
  // The first item, if any. The caller holds the lock.
  std::optional<T> pop_first() {
    if (count_ == 0) return std::nullopt;
    std::optional<T> item(std::move(ring_[first_]));
    first_ = (first_ + 1) % ring_.size();
    --count_;
    changed_.notify_all();
    return item;
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<T> ring_;
  std::size_t first_ = 0;  // in the ring
  std::size_t count_ = 0;
  bool closed_ = false;
};

}  // namespace palpable

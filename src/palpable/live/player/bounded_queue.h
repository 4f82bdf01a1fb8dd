/// @file
/// A queue between threads with a fixed capacity: push() waits while it is full.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

namespace palpable {

/// First in, first out. Any number of threads may push and pop. Only the constructor allocates.
template <class T>
class BoundedQueue {
 public:
  /// @param capacity  items, at least one
  explicit BoundedQueue(std::size_t capacity) : ring_(capacity) {}

  /// Waits for room. If the queue is closed, drops the item and returns false.
  bool push(T item) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return closed_ || count_ < ring_.size(); });
    if (closed_) return false;
    ring_[(first_ + count_) % ring_.size()] = std::move(item);
    ++count_;
    changed_.notify_all();
    return true;
  }

  /// Waits for an item. Returns nothing once the queue is closed and empty.
  std::optional<T> pop() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return closed_ || count_ > 0; });
    return pop_first();
  }

  /// The same with a time limit, s, after which it returns nothing, too; drained() tells the
  /// two cases apart.
  std::optional<T> pop_within(std::chrono::duration<double> wait) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, wait, [this] { return closed_ || count_ > 0; });
    return pop_first();
  }

  /// Whether the queue is closed and empty, so that pop() will never return another item.
  [[nodiscard]] bool drained() {
    const std::lock_guard lock(mutex_);
    return closed_ && count_ == 0;
  }

  [[nodiscard]] bool closed() {
    const std::lock_guard lock(mutex_);
    return closed_;
  }

  /// Refuses further items. Items in the queue can still be popped.
  void close() {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    changed_.notify_all();
  }

 private:
  // Removes and returns the first item, if any. @pre the caller holds the lock
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
  std::size_t first_ = 0;  // index of the first item in ring_
  std::size_t count_ = 0;
  bool closed_ = false;
};

}  // namespace palpable

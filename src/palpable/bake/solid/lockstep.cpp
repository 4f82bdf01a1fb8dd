#include "palpable/bake/solid/lockstep.h"

#include "palpable/common/base/contract.h"

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <exception>
#include <limits>
#include <memory>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

namespace palpable {
namespace {

// Hands out items; keeps the exception of the lowest one that failed.
class Items {
 public:
  explicit Items(const std::function<std::optional<int>()>& next) : next_(next) {}

  std::optional<int> next_item() {
    const std::lock_guard lock(mutex_);
    if (ended_) return std::nullopt;
    try {
      std::optional<int> item = next_();
      ended_ = !item;
      return item;
    } catch (...) {
      keep(std::numeric_limits<int>::max());
      return std::nullopt;
    }
  }

  // Keeps the exception that is being handled as that of `item`; no further item is handed out.
  void failed(int item) {
    const std::lock_guard lock(mutex_);
    keep(item);
  }

  void rethrow() const {
    if (problem_) std::rethrow_exception(problem_);
  }

 private:
  void keep(int item) {
    ended_ = true;
    if (problem_ && item >= item_of_problem_) return;
    problem_ = std::current_exception();
    item_of_problem_ = item;
  }

  std::mutex mutex_;
  const std::function<std::optional<int>()>& next_;
  bool ended_ = false;
  std::exception_ptr problem_;
  int item_of_problem_ = 0;
};

// Decides which lane runs. A lane is ready, running, or waiting for a factor to be applied. To
// apply it, one of the waiting lanes is woken and solves for a batch of them. That happens when no
// other lane can join the batch, or when a thread has nothing else to do.
class LaneGroup {
 public:
  LaneGroup(int lanes, int threads) : lanes_(lanes), threads_(threads) {}

  // The first `count` lanes have threads that call run().
  void begin(std::size_t count) {
    const std::lock_guard lock(mutex_);
    for (std::size_t lane = 0; lane < lanes_.size(); ++lane) {
      if (lane < count) {
        ready_.push_back(&lanes_[lane]);
      } else {
        lanes_[lane].ended = true;
      }
    }
    dispatch();
  }

  void run(std::size_t self, Items& items, const std::function<void(int, Lane&)>& work) {
    Seat& seat = lanes_[self];
    wait_until_granted(seat);
    OfSeat lane(*this, seat);
    while (const std::optional<int> item = items.next_item()) {
      try {
        work(*item, lane);
      } catch (...) { items.failed(*item); }
      const std::lock_guard lock(mutex_);
      seat.factor = nullptr;
      seat.part = 0.0;
    }
    const std::lock_guard lock(mutex_);
    seat.ended = true;
    --running_;
    dispatch();
  }

 private:
  struct Seat {
    std::condition_variable woken;
    bool granted = false;      // the lane may run
    bool ended = false;        // the lane has no more items
    double part = 0.0;         // done, of the item in progress
    std::vector<Seat*> batch;  // the lanes whose systems this one solves
    // The system to be solved, or the item's last one; null before its first.
    const CholeskyFactor* factor = nullptr;
    const Eigen::VectorXd* b = nullptr;
    Eigen::VectorXd* x = nullptr;
    std::exception_ptr problem;
  };

  class OfSeat final : public Lane {
   public:
    OfSeat(LaneGroup& lanes, Seat& seat) : lanes_(lanes), seat_(seat) {}
    void solve(const CholeskyFactor& factor, const Eigen::VectorXd& b,
               Eigen::VectorXd& x) override {
      lanes_.solve(seat_, factor, b, x);
    }
    void report_progress(double part) override {
      const std::lock_guard lock(lanes_.mutex_);
      seat_.part = part;
    }

   private:
    LaneGroup& lanes_;
    Seat& seat_;
  };

  void solve(Seat& seat, const CholeskyFactor& factor, const Eigen::VectorXd& b,
             Eigen::VectorXd& x) {
    // Checked here: a wrong size found in the batch would fail all its lanes.
    PALPABLE_EXPECT(b.size() == factor.size(), "the right-hand side has the size of the matrix");
    {
      const std::lock_guard lock(mutex_);
      seat.factor = &factor;
      seat.b = &b;
      seat.x = &x;
      waiting_.push_back(&seat);
      --running_;
      dispatch();
    }
    wait_until_granted(seat);
    if (seat.problem) std::rethrow_exception(std::exchange(seat.problem, nullptr));
  }

  void wait_until_granted(Seat& seat) {
    std::unique_lock lock(mutex_);
    for (;;) {
      seat.woken.wait(lock, [&] { return seat.granted || !seat.batch.empty(); });
      if (seat.granted) break;
      const std::vector<Seat*> batch = std::exchange(seat.batch, {});
      std::unique_ptr<FactorWorkspace> workspace = free_workspace();
      lock.unlock();
      apply_factor(batch, *workspace);
      lock.lock();
      workspaces_.push_back(std::move(workspace));
      ready_.insert(ready_.end(), batch.begin(), batch.end());
      --running_;
      dispatch();
    }
    seat.granted = false;
  }

  // The caller holds the lock, as for the functions below.
  void dispatch() {
    while (running_ < threads_) {
      std::vector<Seat*> batch = complete_batch();
      if (batch.empty() && ready_.empty() && !waiting_.empty()) {
        batch = batch_of(*waiting_.front()->factor);
      }
      if (!batch.empty()) {
        for (const Seat* const seat : batch) std::erase(waiting_, seat);
        Seat& who = *batch.front();
        who.batch = std::move(batch);
        ++running_;
        who.woken.notify_one();
      } else if (!ready_.empty()) {
        const auto least = std::ranges::min_element(ready_, {}, &Seat::part);
        Seat& who = **least;
        ready_.erase(least);
        who.granted = true;
        ++running_;
        who.woken.notify_one();
      } else {
        return;
      }
    }
  }

  // A batch that no further lane can join: it is as large as it may be, or it holds all lanes that
  // use its factor. A lane with a factor of its own thus never waits for others, nor they for it.
  [[nodiscard]] std::vector<Seat*> complete_batch() const {
    for (const Seat* const first : waiting_) {
      std::vector<Seat*> batch = batch_of(*first->factor);
      const auto may_join = std::ranges::count_if(lanes_, [&](const Seat& seat) {
        return !seat.ended && (!seat.factor || seat.factor == first->factor);
      });
      if (batch.size() == std::min<std::size_t>(CholeskyFactor::kMostTogether,
                                                static_cast<std::size_t>(may_join))) {
        return batch;
      }
    }
    return {};
  }

  // The lanes that wait for a factor, at most kMostTogether: those whose items are least done, and
  // among equals those that have waited longest.
  [[nodiscard]] std::vector<Seat*> batch_of(const CholeskyFactor& factor) const {
    std::vector<Seat*> batch;
    for (Seat* const seat : waiting_) {
      if (seat->factor == &factor) batch.push_back(seat);
    }
    if (batch.size() > CholeskyFactor::kMostTogether) {
      std::ranges::stable_sort(batch, {}, &Seat::part);
      batch.resize(CholeskyFactor::kMostTogether);
    }
    return batch;
  }

  std::unique_ptr<FactorWorkspace> free_workspace() {
    if (workspaces_.empty()) return std::make_unique<FactorWorkspace>();
    std::unique_ptr<FactorWorkspace> workspace = std::move(workspaces_.back());
    workspaces_.pop_back();
    return workspace;
  }

  static void apply_factor(const std::vector<Seat*>& batch, FactorWorkspace& workspace) {
    std::vector<const Eigen::VectorXd*> b;
    std::vector<Eigen::VectorXd*> x;
    for (const Seat* const seat : batch) {
      b.push_back(seat->b);
      x.push_back(seat->x);
    }
    try {
      batch.front()->factor->solve_together(b, x, workspace);
    } catch (...) {
      for (Seat* const seat : batch) seat->problem = std::current_exception();
    }
  }

  std::mutex mutex_;
  std::vector<Seat> lanes_;
  int threads_;
  int running_ = 0;  // lanes that run, and batches that are being solved
  std::deque<Seat*> ready_;
  std::vector<Seat*> waiting_;  // those that have waited longest first
  std::vector<std::unique_ptr<FactorWorkspace>> workspaces_;
};

}  // namespace

void run_in_lockstep(const std::function<std::optional<int>()>& next,
                     const std::function<void(int item, Lane& lane)>& work,
                     const LockstepSettings& settings) {
  PALPABLE_EXPECT(settings.threads >= 1 && settings.lanes >= 1, "at least one lane that runs");
  Items items(next);
  LaneGroup lanes(settings.lanes, settings.threads);
  std::vector<std::thread> threads;
  for (std::size_t lane = 0; lane < static_cast<std::size_t>(settings.lanes); ++lane) {
    try {
      threads.emplace_back([&, lane] { lanes.run(lane, items, work); });
    } catch (const std::system_error&) {  // fewer threads give the same result
      if (threads.empty()) throw;
      break;
    }
  }
  lanes.begin(threads.size());
  for (std::thread& thread : threads) thread.join();
  items.rethrow();
}

}  // namespace palpable

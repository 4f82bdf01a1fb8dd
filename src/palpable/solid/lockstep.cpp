#include "palpable/solid/lockstep.h"

#include "palpable/base/contract.h"

#include <array>
#include <condition_variable>
#include <exception>
#include <limits>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace palpable {
namespace {

// Hands out items and keeps the first exception.
class Items {
 public:
  explicit Items(const std::function<std::optional<int>()>& next) : next_(next) {}

  std::optional<int> take() {
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

  // The exception that is being handled.
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

// Lanes take turns: 0, 1, ... , then the factor is applied for all that wait, then 0 again.
class Group {
 public:
  explicit Group(int lanes) : lanes_(static_cast<std::size_t>(lanes)) {}

  void run(std::size_t self, Items& items, const std::function<void(int, Lane&)>& work) {
    {
      std::unique_lock lock(mutex_);
      wait_for_turn(self, lock);
    }
    OfGroup lane(*this, self);
    while (const std::optional<int> item = items.take()) {
      try {
        work(*item, lane);
      } catch (...) { items.failed(*item); }
    }
    std::unique_lock lock(mutex_);
    lanes_[self].has_left = true;
    pass_turn(self);
  }

 private:
  struct State {
    bool has_left = false;
    std::condition_variable turn_has_come;
    // What is asked for; no factor: nothing.
    const CholeskyFactor* factor = nullptr;
    const Eigen::VectorXd* b = nullptr;
    Eigen::VectorXd* x = nullptr;
    std::exception_ptr problem;
  };

  class OfGroup final : public Lane {
   public:
    OfGroup(Group& group, std::size_t self) : group_(group), self_(self) {}
    void solve(const CholeskyFactor& factor, const Eigen::VectorXd& b,
               Eigen::VectorXd& x) override {
      group_.solve(self_, factor, b, x);
    }

   private:
    Group& group_;
    std::size_t self_;
  };

  void solve(std::size_t self, const CholeskyFactor& factor, const Eigen::VectorXd& b,
             Eigen::VectorXd& x) {
    std::unique_lock lock(mutex_);
    State& state = lanes_[self];
    state.factor = &factor;
    state.b = &b;
    state.x = &x;
    pass_turn(self);
    wait_for_turn(self, lock);
    if (state.problem) std::rethrow_exception(std::exchange(state.problem, nullptr));
  }

  void wait_for_turn(std::size_t self, std::unique_lock<std::mutex>& lock) {
    lanes_[self].turn_has_come.wait(lock, [&] { return turn_ == self; });
  }

  void pass_turn(std::size_t self) {
    for (std::size_t i = self + 1; i < lanes_.size(); ++i) {
      if (!lanes_[i].has_left) return give_turn(i);
    }
    apply_factors();
    for (std::size_t i = 0; i < lanes_.size(); ++i) {
      if (!lanes_[i].has_left) return give_turn(i);
    }
  }

  void give_turn(std::size_t to) {
    turn_ = to;
    lanes_[to].turn_has_come.notify_one();
  }

  // Everybody waits, so nobody minds that the lock is held.
  void apply_factors() {
    for (State& first : lanes_) {
      if (first.factor == nullptr) continue;
      const CholeskyFactor& factor = *first.factor;
      std::array<const Eigen::VectorXd*, CholeskyFactor::kMostTogether> b{};
      std::array<Eigen::VectorXd*, CholeskyFactor::kMostTogether> x{};
      std::array<State*, CholeskyFactor::kMostTogether> of{};
      std::size_t count = 0;
      for (State& state : lanes_) {
        if (state.factor != &factor) continue;
        b[count] = state.b;
        x[count] = state.x;
        of[count++] = &state;
        state.factor = nullptr;
      }
      try {
        factor.solve_together({b.data(), count}, {x.data(), count}, workspace_);
      } catch (...) {
        for (std::size_t i = 0; i < count; ++i) of[i]->problem = std::current_exception();
      }
    }
  }

  std::mutex mutex_;
  std::vector<State> lanes_;
  std::size_t turn_ = 0;
  FactorWorkspace workspace_;
};

}  // namespace

void run_in_lockstep(const std::function<std::optional<int>()>& next,
                     const std::function<void(int item, Lane& lane)>& work,
                     const LockstepSettings& settings) {
  PALPABLE_EXPECT(settings.groups >= 1, "at least one group");
  PALPABLE_EXPECT(settings.lanes >= 1 && settings.lanes <= CholeskyFactor::kMostTogether,
                  "1 to 16 lanes");
  Items items(next);
  std::vector<std::unique_ptr<Group>> groups;
  std::vector<std::thread> threads;
  for (int g = 0; g < settings.groups; ++g) {
    groups.push_back(std::make_unique<Group>(settings.lanes));
  }
  for (int lane = 0; lane < settings.lanes; ++lane) {
    for (const auto& group : groups) {
      threads.emplace_back([&items, &work, &group = *group, self = static_cast<std::size_t>(lane)] {
        group.run(self, items, work);
      });
    }
  }
  for (std::thread& thread : threads) thread.join();
  items.rethrow();
}

}  // namespace palpable

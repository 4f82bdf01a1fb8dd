/// @file
/// Who works on a campaign: the threads of one process, or of several (mpi_crew.h).
#pragma once

#include <functional>
#include <optional>
#include <vector>

namespace palpable {

/// How a process comes by its pieces of work.
struct Pieces {
  std::function<std::optional<int>()> next;
  /// Two numbers for the leader about a piece that is done: which work it was, and how it went.
  std::function<void(int what, int answer)> finished;
};

/// Hands out numbered pieces of work. All processes of a crew call the same members in the same
/// order.
class Crew {
 public:
  virtual ~Crew() = default;

  /// One process leads: it looks after the store, shows progress, reduces.
  [[nodiscard]] virtual bool leads() const = 0;
  /// Threads that this process is to use where the user asked for `wanted`; 0: as many as fit.
  [[nodiscard]] virtual int threads(int wanted) const = 0;
  /// The leader's list, in every process.
  [[nodiscard]] virtual std::vector<int> agree(std::vector<int> list) = 0;

  /// Hands out each 0 <= i < count once, in increasing order: every process calls run() once, which
  /// asks `next` for pieces, from any of its threads, until there are none, and calls `finished`
  /// for each. In the leader, finished() is then called with the same numbers, one call at a time.
  /// @throws what run() threw, when all processes have ended; nothing more is handed out then. In
  ///         a process that does not lead: an Error for a failure of any other
  virtual void share(int count, const std::function<void(const Pieces&)>& run,
                     const std::function<void(int, int)>& finished) = 0;
};

/// The threads of this process.
class LocalCrew : public Crew {
 public:
  [[nodiscard]] bool leads() const override { return true; }
  [[nodiscard]] int threads(int wanted) const override;
  [[nodiscard]] std::vector<int> agree(std::vector<int> list) override { return list; }
  void share(int count, const std::function<void(const Pieces&)>& run,
             const std::function<void(int, int)>& finished) override;
};

}  // namespace palpable

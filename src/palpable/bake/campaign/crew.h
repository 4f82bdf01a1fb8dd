/// @file
/// The workers of a campaign: the threads of one process, or of several processes (mpi_crew.h).
#pragma once

#include <functional>
#include <optional>
#include <vector>

namespace palpable {

/// How a process gets pieces of work and reports them as finished.
struct Pieces {
  std::function<std::optional<int>()> next;  ///< number of the next piece; nothing: no more
  /// Reports a finished piece to the leader by two numbers, which are passed on unchanged: what was
  /// done, and its result.
  std::function<void(int what, int result)> finished;
};

/// Hands out numbered pieces of work. All processes of a crew call the same members in the same
/// order.
class Crew {
 public:
  virtual ~Crew() = default;

  /// Whether this process is the leader, which manages the store, shows progress and reduces.
  [[nodiscard]] virtual bool leads() const = 0;
  /// Number of threads for this process. @param wanted  requested by the user; 0: as many as fit
  [[nodiscard]] virtual int threads(int wanted) const = 0;
  /// Returns the leader's list in every process.
  [[nodiscard]] virtual std::vector<int> agree(std::vector<int> list) = 0;

  /// Hands out each 0 <= i < count once, in increasing order. Every process calls run() once; run()
  /// takes pieces by `next`, from any of its threads, until there are none, and calls `finished`
  /// for each. In the leader, finished() is then called with the same numbers, one call at a time.
  /// @throws what run() threw, after all processes have ended; no piece is handed out after a
  ///         failure. In a process that is not the leader: an Error when any other process failed
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

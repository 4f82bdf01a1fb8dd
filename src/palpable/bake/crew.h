/// @file
/// Who works on a campaign: the threads of one process, or of several (mpi_crew.h).
#pragma once

#include <functional>
#include <vector>

namespace palpable {

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

  /// Runs work(i) once for each 0 <= i < count, somewhere, in increasing order of i as threads are
  /// free. In the leader, finished(i, work(i)) follows, one call at a time.
  /// @throws what work threw for the lowest i, when all have ended; pieces not begun are left out.
  ///         In a process that does not lead: an Error for a failure of any other
  virtual void share(int count, int threads, const std::function<int(int)>& work,
                     const std::function<void(int, int)>& finished) = 0;
};

/// The threads of this process.
class LocalCrew : public Crew {
 public:
  [[nodiscard]] bool leads() const override { return true; }
  [[nodiscard]] int threads(int wanted) const override;
  [[nodiscard]] std::vector<int> agree(std::vector<int> list) override { return list; }
  void share(int count, int threads, const std::function<int(int)>& work,
             const std::function<void(int, int)>& finished) override;
};

}  // namespace palpable

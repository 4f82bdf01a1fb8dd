/// @file
/// A campaign on several machines: `mpirun -n N palpable bake ...` (Open MPI).
///
/// All processes see the same files. The first one leads: it hands out sites one at a time, so that
/// a slow machine delays no other, and also computes itself. A waiting process polls for messages
/// and sleeps in between, because a blocking receive of Open MPI takes a whole core.
#pragma once

#include "palpable/bake/campaign/crew.h"

#include <cstdio>
#include <functional>
#include <vector>

namespace palpable {

class MpiCrew : public Crew {
 public:
  /// Whether this process was started by mpirun beside others.
  [[nodiscard]] static bool is_launched();

  MpiCrew(int* argc, char*** argv);
  ~MpiCrew() override;

  [[nodiscard]] bool leads() const override { return rank_ == 0; }
  [[nodiscard]] int size() const { return size_; }
  /// Threads of this process: `wanted`, or for 0 an equal share of the cores of its machine.
  [[nodiscard]] int threads(int wanted) const override;
  [[nodiscard]] std::vector<int> agree(std::vector<int> list) override;
  void share(int count, const std::function<void(const Pieces&)>& run,
             const std::function<void(int, int)>& finished) override;

  /// Must be the last call of each process. The followers wait in it for the leader.
  /// @param failed  this process ends with an error; all others are then aborted
  void end(bool failed);

 private:
  void lead(int count, const std::function<void(const Pieces&)>& run,
            const std::function<void(int, int)>& finished);
  void follow(const std::function<void(const Pieces&)>& run);

  int rank_ = 0, size_ = 1;
  bool ended_ = false;
  std::FILE* kept_ = nullptr;  // file to which a follower's stderr goes
  int stderr_ = -1;            // the original stderr of a follower
};

}  // namespace palpable

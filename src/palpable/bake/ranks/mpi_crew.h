/// @file
/// A campaign on several machines: `mpirun -n N palpable bake ...` (Open MPI).
///
/// All processes see the same files. The first one leads; it hands out sites one at a time, so a
/// slow machine holds nobody up, and works itself. Waiting processes sleep between looks at their
/// mail: Open MPI's own waiting takes a whole core.
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
  /// Cores are shared among the processes of a machine.
  [[nodiscard]] int threads(int wanted) const override;
  [[nodiscard]] std::vector<int> agree(std::vector<int> list) override;
  void share(int count, const std::function<void(const Pieces&)>& run,
             const std::function<void(int, int)>& finished) override;

  /// The last that a process does; the others wait for the leader.
  /// @param failed  this process ends with an error: so do all
  void end(bool failed);

 private:
  void lead(int count, const std::function<void(const Pieces&)>& run,
            const std::function<void(int, int)>& finished);
  void follow(const std::function<void(const Pieces&)>& run);

  int rank_ = 0, size_ = 1;
  bool ended_ = false;
  std::FILE* kept_ = nullptr;  // what a follower has written to stderr
  int stderr_ = -1;            // stderr itself, of a follower
};

}  // namespace palpable

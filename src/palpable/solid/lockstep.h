/// @file
/// Solves that go side by side and share each pass through a factor.
///
/// Every solve is written as if it were alone, on a thread of its own: a *lane*. Up to 16 lanes
/// make a group, of which one runs at a time. A lane that wants the factor applied waits, and when
/// all that are left wait, one pass through the factor serves them all
/// (CholeskyFactor::solve_together): on a bunny of 16,000 nodes 2.2 ms each instead of 16, on a
/// machine whose memory others used, too.
///
/// What a lane computes does not depend on the others, to the bit. So neither the number of groups
/// and lanes nor the order of the items matters to any result.
#pragma once

#include "palpable/solid/sparse_cholesky.h"

#include <Eigen/Core>

#include <functional>
#include <optional>

namespace palpable {

/// A lane, as the solve that runs on it sees it.
class Lane {
 public:
  virtual ~Lane() = default;
  /// CholeskyFactor::solve_roughly(), together with what the other lanes of the group ask of the
  /// same factor. Others run meanwhile.
  virtual void solve(const CholeskyFactor& factor, const Eigen::VectorXd& b,
                     Eigen::VectorXd& x) = 0;
};

struct LockstepSettings {
  int groups = 1;                             ///< that many cores are used, >= 1
  int lanes = CholeskyFactor::kMostTogether;  ///< of each group, 1 .. 16: memory for speed
};

/// Calls work(item, lane) for every item that `next` hands out, as soon as a lane is free, until it
/// hands out none. Exceptions end it: nothing more is handed out, what runs is brought to its end,
/// then that of the lowest item is thrown; one from `next` counts as that of a last item.
/// @param next  called by one thread at a time, but not always by the same
/// @param work  called by several threads
void run_in_lockstep(const std::function<std::optional<int>()>& next,
                     const std::function<void(int item, Lane& lane)>& work,
                     const LockstepSettings& settings);

}  // namespace palpable

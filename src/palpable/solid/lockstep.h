/// @file
/// Solves that go side by side and share each pass through a factor.
///
/// Every solve is written as if it were alone, on a thread of its own: a *lane*. A lane that wants
/// the factor applied waits; when 16 wait for it, or all that use it do, or a core has nothing else
/// to do, one pass through the factor serves them (CholeskyFactor::solve_together): on a bunny of
/// 16,000 nodes 2.2 ms each instead of 16, on a machine whose memory others used, too. As many
/// lanes run at a time as cores may be used.
///
/// What a lane computes does not depend on the others, to the bit. So neither the number of cores
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
  /// CholeskyFactor::solve_roughly(), together with what other lanes ask of the same factor. Others
  /// run meanwhile.
  virtual void solve(const CholeskyFactor& factor, const Eigen::VectorXd& b,
                     Eigen::VectorXd& x) = 0;
  /// Says how much of the item is done, 0 .. 1. Of those that could go on, the one that is least
  /// far does: a hard item then ends with the easy ones, and not alone long after them.
  virtual void progressed(double part) = 0;
};

struct LockstepSettings {
  int threads = 1;  ///< that run at a time, >= 1
  /// Items in progress, >= 1: some more than 16 for each thread keep every pass full. Each costs
  /// the memory of its solve.
  int lanes = 20;
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

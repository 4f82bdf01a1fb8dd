/// @file
/// Solves that run side by side and share each pass through a factor.
///
/// Every solve is written as if it were alone. It runs on a thread of its own, a *lane*, of which
/// LockstepSettings::threads run at a time. A lane that needs the factor applied waits, until one
/// pass through the factor serves all that wait for it (CholeskyFactor::solve_together). The pass
/// is made when 16 lanes wait for this factor, when all lanes that use it wait, or when a core has
/// nothing else to do. On a bunny of 16,000 nodes an application costs 2.2 ms in a full pass and
/// 16 ms alone (on a machine whose memory other programs used too).
///
/// What a lane computes does not depend on the other lanes, to the bit. So neither the number of
/// cores and lanes nor the order of the items changes any result.
#pragma once

#include "palpable/bake/solid/sparse_cholesky.h"

#include <Eigen/Core>

#include <functional>
#include <optional>

namespace palpable {

/// The lane that a solve runs on, as the solve sees it.
class Lane {
 public:
  virtual ~Lane() = default;
  /// CholeskyFactor::solve_roughly(), in one pass with the systems of other lanes that use the same
  /// factor. The thread waits; other lanes run meanwhile.
  virtual void solve(const CholeskyFactor& factor, const Eigen::VectorXd& b,
                     Eigen::VectorXd& x) = 0;
  /// Reports how much of the item is done, 0 .. 1. Of the lanes that are ready, the one that has
  /// done least runs next. Without that, hard items would end long after the easy ones, alone, and
  /// pay for whole passes.
  virtual void report_progress(double part) = 0;
};

struct LockstepSettings {
  int threads = 1;  ///< lanes that run at a time, >= 1
  /// Items in progress, >= 1. A few more than 16 for each thread keep every pass full. Each item
  /// costs the memory of its solve.
  int lanes = 20;
};

/// Calls work(item, lane) for every item that `next` returns, as soon as a lane is free, until it
/// returns none. After an exception no further item begins, those in progress are finished, and the
/// exception of the lowest item is thrown again; one thrown by `next` counts as that of a last
/// item.
/// @param next  called by one thread at a time, but not always by the same one
/// @param work  called by several threads at once
void run_in_lockstep(const std::function<std::optional<int>()>& next,
                     const std::function<void(int item, Lane& lane)>& work,
                     const LockstepSettings& settings);

}  // namespace palpable

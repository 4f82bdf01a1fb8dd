/// @file
/// A loop whose items are distributed over several threads.
#pragma once

#include "palpable/common/base/progress.h"

#include <functional>
#include <string>

namespace palpable {

/// Calls work(0) .. work(count - 1), each once; calls begin in this order, but several run at a
/// time. After an exception, of work or of `progress`, no further item begins, and the first
/// exception is thrown again when all threads have ended.
/// @param task      name of the task in the progress reports, one for each finished item
void work_in_parallel(int count, int threads, const std::string& task, const Progress& progress,
                      const std::function<void(int item)>& work);

}  // namespace palpable

/// @file
/// A loop whose items are worked on by several threads.
#pragma once

#include "palpable/common/base/progress.h"

#include <functional>
#include <string>

namespace palpable {

/// Calls work(0) .. work(count - 1), each once, in their order but several at a time. After an
/// exception no further item begins, and the first one is thrown again.
/// @param task      of the reports, one for each item that is done
void work_in_parallel(int count, int threads, const std::string& task, const Progress& progress,
                      const std::function<void(int item)>& work);

}  // namespace palpable

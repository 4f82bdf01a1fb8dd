/// @file
/// The scores that compare images frame by frame: depth, moving mask, occlusion.
#pragma once

#include "apps/common/json.h"
#include "apps/palpable/score_files.h"
#include "palpable/base/progress.h"

namespace palpable::app {

/// Reads each image once and adds their scores, by the names of docs/benchmark.md; null where truth
/// or result has no such images.
/// @throws Error naming the file that cannot be read or has another size than its truth
void score_images(const TruthFolder& truth, const ResultFolder& result, const Progress& progress,
                  Json& scores);

}  // namespace palpable::app

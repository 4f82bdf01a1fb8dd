/// @file
/// The scores of the drawn surface: how deep the hand is left in it, and how it jumps.
#pragma once

#include "apps/common/json.h"
#include "apps/palpable/score_files.h"
#include "palpable/reduced/reduced_body.h"

namespace palpable::app {

/// Adds penetration and pop, by the names of docs/benchmark.md. The surface of a frame is
/// RESULT/meshes/%06d.ply where there is such a folder, else the body deformed by the frame's touch
/// (site and level); null when neither is at hand, when a touch does not say both, or when the
/// result has no pose.
/// @param body  of the run; may be null
/// @throws Error naming the file that cannot be read, or the site that `body` does not have
void score_surface(const TruthFolder& truth, const ResultFolder& result, const ReducedBody* body,
                   Json& scores);

}  // namespace palpable::app

/// @file
/// Faults of light and rig, to be laid over a planned sequence.
#pragma once

#include "palpable/desk/script/sequence.h"

#include <string_view>

namespace palpable {

/// "dark", "textureless", "exposure", "rolling" or "drift".
[[nodiscard]] bool is_disturbance(std::string_view name);

/// Gives the sequence its new name, and
///
///     dark         a thirtieth of the light; the sensor's gain makes 2 grey levels of noise
///     textureless  a bare white desk and a bare room
///     exposure     every 3 s the light on both eyes jumps, between 0.45 and 1.5 of normal
///     rolling      16 ms from reading the first row to the last, and a camera that sways
///     drift        the right image sinks: by 0.5 px at 5 s, by 1 px at 12 s, and by 0.02 px/s
///                  from then on
///
/// @throws ContractViolation for another name
void disturb(std::string_view name, Sequence& sequence);

}  // namespace palpable

/// @file
/// Faults of light and rig that are added to a planned sequence.
#pragma once

#include "palpable/desk/script/sequence.h"

#include <string_view>

namespace palpable {

/// "dark", "textureless", "exposure", "rolling" or "drift".
[[nodiscard]] bool is_disturbance(std::string_view name);

/// Gives the sequence its new name and changes it:
///
///     dark         1/30 of the light; the sensor's gain raises the noise to 2 grey levels
///     textureless  a bare white desk and a bare room
///     exposure     every 3 s the light in both eyes jumps, between 0.45 and 1.5 of normal
///     rolling      a readout of 16 ms from the first row to the last, and a swaying camera
///     drift        the right image moves down: by 0.5 px at 5 s, by another 1 px at 12 s,
///                  and by 0.02 px/s from then on
///
/// @throws ContractViolation for another name
void disturb(std::string_view name, Sequence& sequence);

}  // namespace palpable

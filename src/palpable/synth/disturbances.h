/// @file
/// What goes wrong with light and rig: laid over a sequence with presses.
#pragma once

#include "palpable/synth/sequence.h"

#include <string_view>

namespace palpable {

/// "dark", "textureless", "exposure", "rolling" or "drift".
[[nodiscard]] bool is_disturbance(std::string_view name);

/// Gives the sequence its new name, and
///
///     dark         a thirtieth of the light; the sensor's gain makes 2 grey levels of noise
///     textureless  a bare white desk and a bare room
///     exposure     steps of both eyes between 0.45 and 1.5 of the light, every 3 s
///     rolling      16 ms from the first row to the last, and a camera that sways
///     drift        the right image lies lower by 0.5 px from 5 s on, by 1 px more from 12 s on,
///     and
///                  sinks by 0.02 px/s after that
///
/// @throws ContractViolation for another name
void disturb(std::string_view name, Sequence& sequence);

}  // namespace palpable

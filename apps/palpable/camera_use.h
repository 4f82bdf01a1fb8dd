/// @file
/// Commands with which a connected camera is used in this program.
#pragma once

#include "palpable/live/sources/camera_list.h"

#include <string>

namespace palpable::app {

/// The commands to type for it, as lines to follow text_of(camera); empty if it cannot be used.
[[nodiscard]] std::string use_of(const ListedCamera& camera);

}  // namespace palpable::app

/// @file
/// How a camera that is plugged in is used with this program.
#pragma once

#include "palpable/live/sources/camera_list.h"

#include <string>

namespace palpable::app {

/// What to type for it, in lines below text_of(camera); nothing where it cannot be used.
[[nodiscard]] std::string use_of(const ListedCamera& camera);

}  // namespace palpable::app

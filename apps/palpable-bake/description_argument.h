/// @file
/// The argument BODY.toml of commands that mesh and solve.
#pragma once

#include "palpable/bake/describe/body_description.h"

#include <string>

namespace palpable::app {

/// Reads a description. Where the file is the body's surface or mesh instead, which people try
/// first, a description of it to begin with is printed on stderr before that is refused.
[[nodiscard]] BodyDescription read_description(const std::string& file);

}  // namespace palpable::app

/// @file
/// The argument BODY.toml of commands that mesh and solve.
#pragma once

#include "palpable/bake/describe/body_description.h"

#include <string>

namespace palpable::app {

class Command;

/// Reads a description. If the file is the body's surface or mesh, a frequent mistake, it prints a
/// minimal description of it on stderr and throws.
[[nodiscard]] BodyDescription read_description(const std::string& file);

/// Adds the argument: the description's file, as first word or after --description; required.
void add_description(Command command, std::string& file);

}  // namespace palpable::app

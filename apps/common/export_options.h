/// @file
/// What both programs declare of `palpable export`: each has formats of its own, and to the user it
/// is one command.
#pragma once

#include "apps/common/command_line.h"

#include <string>

namespace palpable::app {

/// --inline of a page: "auto", "always" or "never".
void add_inline_option(Command command, std::string& holds_all);

}  // namespace palpable::app

/// @file
/// The option --paint, of all commands that have it.
#pragma once

#include "apps/common/command_line.h"
#include "palpable/view/show_names.h"

#include <string>

namespace palpable::app {

/// Adds --paint. @param paint  one of kPaints' names, and what it is without the option
void add_paint_option(Command command, std::string& paint);

/// @param name  as the option has read it
[[nodiscard]] const NamedPaint& paint_named(const std::string& name);

}  // namespace palpable::app

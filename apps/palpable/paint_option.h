/// @file
/// The option --paint, of all commands that have it.
#pragma once

#include "apps/common/command_line.h"
#include "palpable/live/view/show_names.h"

#include <filesystem>
#include <string>

namespace palpable::app {

/// Adds --paint. @param paint  one of kPaints' names, and what it is without the option
void add_paint_option(Command command, std::string& paint);

/// @param name  as the option has read it
[[nodiscard]] const NamedPaint& paint_named(const std::string& name);

/// @param knows_stress  of the body in this file (painted_stress.h)
/// @param knows_contact  whether it is pressed anywhere, not at its sites
/// @throws Error where what is to be painted is not known of it
void expect_paintable(const std::string& paint, bool knows_stress, bool knows_contact,
                      const std::filesystem::path& body);

}  // namespace palpable::app

/// @file
/// The option --paint, shared by several commands.
#pragma once

#include "apps/common/command_line.h"
#include "palpable/live/view/show_names.h"

#include <filesystem>
#include <string>

namespace palpable::app {

/// Adds --paint. @param paint receives one of kPaints' names; its present value is the default
void add_paint_option(Command command, std::string& paint);

/// @param name  as read by the option
[[nodiscard]] const NamedPaint& paint_named(const std::string& name);

/// @param knows_stress  whether the body in this file has stress (painted_stress.h)
/// @param knows_contact  whether it has contact pressure, i.e. is not pressed at sites
/// @throws Error when the body does not have the quantity to be painted
void expect_paintable(const std::string& paint, bool knows_stress, bool knows_contact,
                      const std::filesystem::path& body);

}  // namespace palpable::app

// palpable cameras: what is plugged in, and what it can do.

#include "apps/common/command_line.h"
#include "apps/palpable/camera_list.h"
#include "apps/palpable/commands.h"
#include "apps/palpable/source_options.h"

#include <fmt/core.h>

#include <memory>

namespace palpable::app {

void add_cameras(Command app) {
  auto json = std::make_shared<bool>(false);
  Command command =
      app.add_subcommand("cameras", "List the cameras that are plugged in, and what each can do");
  command.add_flag("--json", *json, "One JSON object on stdout");
  command.footer(
      "Says the sizes, formats and rates of each device, whether its picture looks like two eyes "
      "side by "
      "side, whether exposure and gain can be fixed, and the calibration that is known of it.\n"
      "Example: palpable cameras");
  command.callback(
      [json] { fmt::print("{}", camera_list(linux_video(), calibration_folders(), *json)); });
}

}  // namespace palpable::app

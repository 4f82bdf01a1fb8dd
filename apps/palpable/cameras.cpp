// palpable cameras: what is plugged in, and what it can do.

#include "apps/palpable/camera_list.h"
#include "apps/palpable/commands.h"
#include "apps/palpable/source_options.h"

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include <memory>

namespace palpable::app {

void add_cameras(CLI::App& app) {
  auto json = std::make_shared<bool>(false);
  CLI::App* command = app.add_subcommand("cameras", "What is plugged in, and what it can do");
  command->add_flag("--json", *json, "One JSON object on stdout");
  command->footer(
      "Sizes, formats and rates of each device, whether its picture looks like two eyes side by\n"
      "side, whether exposure and gain can be fixed, and the calibration that is known of it.\n"
      "Example: palpable cameras");
  command->callback(
      [json] { fmt::print("{}", camera_list(linux_video(), calibration_folders(), *json)); });
}

}  // namespace palpable::app

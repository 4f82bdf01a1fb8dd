// palpable cameras: the connected cameras, their capabilities, and the commands that use them.

#include "apps/common/command_line.h"
#include "apps/palpable/camera_use.h"
#include "apps/palpable/commands.h"
#include "palpable/live/sources/camera_list.h"
#include "palpable/live/sources/camera_source.h"

#include <fmt/core.h>

#include <memory>
#include <vector>

namespace palpable::app {
namespace {

void print_cameras(bool json) {
  const std::vector<ListedCamera> cameras = list_cameras(linux_video(), calibration_folders());
  if (json) {
    fmt::print("{}\n", json_of(cameras).dump(2));
    return;
  }
  if (cameras.empty()) {
    fmt::print(
        "no camera: there is no /dev/video* (is it plugged in, and passed on to a container?)\n"
        "What needs none: a folder of images, a video file, --source synthetic; see palpable "
        "live --help\n");
  }
  for (const ListedCamera& camera : cameras) fmt::print("{}{}", text_of(camera), use_of(camera));
}

}  // namespace

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
  command.callback([json] { print_cameras(*json); });
}

}  // namespace palpable::app

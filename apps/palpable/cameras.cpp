// palpable cameras: the connected cameras, their capabilities, and the commands that use them.

#include "apps/common/command_line.h"
#include "apps/common/printing.h"
#include "apps/palpable/commands.h"
#include "palpable/live/sources/camera_list.h"
#include "palpable/live/sources/camera_source.h"

#include <fmt/core.h>

#include <memory>
#include <string>
#include <vector>

namespace palpable::app {
namespace {

void print_cameras(bool json) {
  const std::vector<ListedCamera> cameras = list_cameras(linux_video(), calibration_folders());
  if (json) {
    print_json(json_of(cameras));
    return;
  }
  if (cameras.empty()) {
    print_text(
        "no camera: there is no /dev/video* (is it plugged in, and passed on to a container? A ZED "
        "Mini needs a USB 3 port and its own cable)\n"
        "What needs none: a folder of images, a video file, or the built-in desk: palpable live\n");
  }
  for (const ListedCamera& camera : cameras) print_text("{}{}", text_of(camera), use_of(camera));
}

}  // namespace

std::string use_of(const ListedCamera& camera) {
  const std::string& path = camera.info.path;
  switch (camera.kind) {
    case CameraKind::kUnreadable:
      break;
    case CameraKind::kSideBySide:
    case CameraKind::kInterleaved:
      return fmt::format("  calibration: {}\n  use: palpable live BODY --source {}\n",
                         camera.calibration.empty()
                             ? fmt::format("none known; palpable calibrate {} makes one", path)
                             : camera.calibration.string(),
                         path);
    case CameraKind::kDepth:
      if (!camera.pictures.empty()) {
        return fmt::format(
            "  use: palpable live BODY --source {} --depth-source {} --calibration "
            "intrinsics.txt\n",
            camera.pictures, path);
      }
      return fmt::format(
          "  use: palpable live BODY --source DEVICE --depth-source {}, where DEVICE has the same "
          "view\n",
          path);
    case CameraKind::kGray16:
      return fmt::format(
          "  use, if its Y16 is depth: palpable live BODY --source DEVICE --depth-source {} "
          "--depth-unit LENGTH\n",
          path);
    case CameraKind::kOneEye:
      return fmt::format(
          "  use: palpable live BODY --source {} --right DEVICE, where DEVICE is the right eye\n",
          path);
  }
  return {};
}

void add_cameras(Command app) {
  auto json = std::make_shared<bool>(false);
  Command command =
      app.add_subcommand("cameras", "List the cameras that are plugged in, and what each can do");
  command.add_json(*json);
  command.footer(
      "Says the sizes, formats and rates of each device, whether its picture looks like two eyes "
      "side by side or interleaved, whether exposure and gain can be fixed, whether it is on a USB "
      "2 port, which programs have opened it, and the calibration that is known of it.\n"
      "Example: palpable cameras");
  command.callback([json] { print_cameras(*json); });
}

}  // namespace palpable::app

#include "apps/palpable/commands.h"
#include "palpable/live/sources/camera_list.h"
#include "tests/support/test.h"

#include <string>

namespace palpable::app {
namespace {

ListedCamera camera_of(CameraKind kind) {
  ListedCamera camera;
  camera.info.path = "/dev/video2";
  camera.kind = kind;
  return camera;
}

TEST_CASE("what is said of a camera's use can be typed", "[apps][camera]") {
  ListedCamera both = camera_of(CameraKind::kSideBySide);
  CHECK(use_of(both) ==
        "  calibration: none known; palpable calibrate /dev/video2 makes one\n"
        "  use: palpable live BODY --source /dev/video2\n");
  both.calibration = "zed-m.yml";
  CHECK(use_of(both) ==
        "  calibration: zed-m.yml\n"
        "  use: palpable live BODY --source /dev/video2\n");
  CHECK(use_of(camera_of(CameraKind::kInterleaved)) ==
        "  calibration: none known; palpable calibrate /dev/video2 makes one\n"
        "  use: palpable live BODY --source /dev/video2\n");
  CHECK(use_of(camera_of(CameraKind::kOneEye)) ==
        "  use: palpable live BODY --source /dev/video2 --right DEVICE, where DEVICE is the right "
        "eye\n");
  CHECK(use_of(camera_of(CameraKind::kDepth)) ==
        "  use: palpable live BODY --source DEVICE --depth-source /dev/video2, where DEVICE has "
        "the same "
        "view\n");
  ListedCamera depth = camera_of(CameraKind::kDepth);
  depth.pictures = "/dev/video4";
  CHECK(use_of(depth) ==
        "  use: palpable live BODY --source /dev/video4 --depth-source /dev/video2 --calibration "
        "intrinsics.txt\n");
  CHECK(use_of(camera_of(CameraKind::kGray16)) ==
        "  use, if its Y16 is depth: palpable live BODY --source DEVICE --depth-source /dev/video2 "
        "--depth-unit LENGTH\n");
  CHECK(use_of(camera_of(CameraKind::kUnreadable)).empty());
}

}  // namespace
}  // namespace palpable::app

#include "apps/palpable/camera_list.h"

#include "palpable/sources/raw_picture.h"
#include "tests/support/fake_video.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <nlohmann/json.hpp>

#include <cerrno>
#include <fstream>
#include <string>

namespace palpable::app {
namespace {

constexpr std::uint32_t kYuyv = four_letters("YUYV");
constexpr std::uint32_t kGrey = four_letters("GREY");
constexpr std::uint32_t kDepth = four_letters("Z16 ");

bool contains(const std::string& text, const std::string& part) {
  UNSCOPED_INFO(text);
  return text.find(part) != std::string::npos;
}

test::FakeDevice device(const char* path, const char* card, std::vector<test::FakeMode> modes) {
  test::FakeDevice camera;
  camera.path = path;
  camera.card = card;
  camera.modes = std::move(modes);
  return camera;
}

// One of each kind: both eyes side by side, one eye, depth, one that nobody may open, one whose
// pictures cannot be read.
test::FakeVideo one_of_each() {
  test::FakeVideo video;
  video.cameras = {device("/dev/video0", "ZED-M", {{kYuyv, 2560, 720, {60, 30}}}),
                   device("/dev/video1", "Webcam", {{kGrey, 640, 480, {30}}}),
                   device("/dev/video2", "Depth", {{kDepth, 640, 360, {90}}}),
                   device("/dev/video3", "Private", {{kGrey, 640, 480, {30}}}),
                   device("/dev/video4", "Odd", {{four_letters("H265"), 640, 480, {30}}})};
  video.cameras[0].controls = {{V4L2_CID_EXPOSURE_ABSOLUTE, 100}, {V4L2_CID_GAIN, 4}};
  video.cameras[3].open_error = EACCES;
  return video;
}

TEST_CASE("cameras lists what each device can do, how it is used, and why one cannot be asked",
          "[apps][camera]") {
  test::FakeVideo video = one_of_each();
  const test::ScratchFolder folder("camera_list");
  const std::string text = camera_list(video, {folder.path()}, false);
  CHECK(contains(text, "/dev/video0  ZED-M"));
  CHECK(contains(text,
                 "  2560x720  YUYV  both eyes side by side  60, 30 fps\n"
                 "  exposure can be fixed, gain can be fixed\n"
                 "  calibration: none known; palpable calibrate --source /dev/video0 makes "
                 "one\n"
                 "  use: palpable live BODY --source /dev/video0\n"));
  CHECK(contains(text,
                 "   640x480  GREY  one eye                 30 fps\n"
                 "  exposure cannot be fixed, gain cannot be fixed\n"
                 "  use: palpable live BODY --source /dev/video1 --right DEVICE"));
  CHECK(contains(text, "   640x360  Z16   depth                   90 fps\n"));
  CHECK(contains(text, "--depth /dev/video2"));
  CHECK(contains(text, "/dev/video3"));
  CHECK(contains(text, "/dev/video4  Odd"));
  CHECK(contains(text, "  no picture format that can be read\n"));
  CHECK(video.opened == 0);
}

TEST_CASE("the calibration that live would take is named", "[apps][camera]") {
  test::FakeVideo video = one_of_each();
  const test::ScratchFolder folder("camera_list");
  const std::filesystem::path file = folder.path() / "zed-m-1280x720.yml";
  std::ofstream(file) << "%YAML:1.0\n";
  CHECK(contains(camera_list(video, {folder.path()}, false),
                 "  calibration: " + file.string() + "\n"));
  CHECK(nlohmann::json::parse(camera_list(video, {folder.path()},
                                          true))["cameras"][0]["calibration"] == file.string());
}

TEST_CASE("cameras --json says the same to programs", "[apps][camera]") {
  test::FakeVideo video = one_of_each();
  const nlohmann::json cameras = nlohmann::json::parse(camera_list(video, {}, true))["cameras"];
  REQUIRE(cameras.size() == 5);
  CHECK(cameras[0]["name"] == "ZED-M");
  CHECK(cameras[0]["exposure"] == true);
  CHECK(cameras[0]["calibration"].is_null());
  const nlohmann::json mode = {{"width", 2560},
                               {"height", 720},
                               {"format", "YUYV"},
                               {"kind", "both eyes side by side"},
                               {"fps", {60.0, 30.0}}};
  CHECK(cameras[0]["modes"] == nlohmann::json::array({mode}));
  CHECK(cameras[1]["gain"] == false);
  CHECK(cameras[2]["modes"][0]["kind"] == "depth");
  CHECK(contains(cameras[3]["trouble"], "/dev/video3"));
  CHECK(cameras[4]["modes"].empty());
  test::FakeVideo none;
  CHECK(nlohmann::json::parse(camera_list(none, {}, true))["cameras"].empty());
  CHECK(contains(camera_list(none, {}, false), "no camera: there is no /dev/video*"));
}

}  // namespace
}  // namespace palpable::app

#include "palpable/live/sources/camera_list.h"

#include "palpable/live/sources/camera_source.h"
#include "palpable/live/sources/raw_picture.h"
#include "tests/support/fake_video.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

namespace palpable {
namespace {

using Catch::Matchers::Contains;
using Catch::Matchers::EndsWith;
using Catch::Matchers::StartsWith;

constexpr std::uint32_t kYuyv = four_letters("YUYV");
constexpr std::uint32_t kGrey = four_letters("GREY");
constexpr std::uint32_t kDepth = four_letters("Z16 ");

test::FakeDevice device(const char* path, const char* card, std::vector<test::FakeMode> modes) {
  test::FakeDevice camera;
  camera.path = path;
  camera.card = card;
  camera.modes = std::move(modes);
  return camera;
}

// One device of each kind: both eyes side by side, one eye, depth, one without permission, one with
// an unknown format.
test::FakeVideo one_of_each() {
  test::FakeVideo video;
  video.cameras = {device("/dev/video0", "ZED-M", {{kYuyv, 2560, 720, {60, 30}}}),
                   device("/dev/video1", "Webcam", {{kGrey, 640, 480, {30}}}),
                   device("/dev/video2", "Depth", {{kDepth, 640, 360, {90}}}),
                   device("/dev/video3", "Private", {{kGrey, 640, 480, {30}}}),
                   device("/dev/video4", "Odd", {{four_letters("H265"), 640, 480, {30}}}),
                   device("/dev/video5", "Gray", {{four_letters("Y16 "), 640, 480, {30}}})};
  video.cameras[0].controls = {{V4L2_CID_EXPOSURE_ABSOLUTE, 100}, {V4L2_CID_GAIN, 4}};
  video.cameras[3].open_error = EACCES;
  return video;
}

TEST_CASE("the list says what each device can do, and why one cannot be asked",
          "[sources][camera]") {
  test::FakeVideo video = one_of_each();
  const test::ScratchFolder folder("camera_list");
  const std::vector<ListedCamera> cameras = list_cameras(video, {folder.path()});
  REQUIRE(cameras.size() == 6);
  const CameraKind kinds[] = {CameraKind::kSideBySide, CameraKind::kOneEye,
                              CameraKind::kDepth,      CameraKind::kUnreadable,
                              CameraKind::kUnreadable, CameraKind::kGray16};
  for (std::size_t i = 0; i < 6; ++i) CHECK(cameras[i].kind == kinds[i]);
  CHECK_THAT(text_of(cameras[0]),
             StartsWith("/dev/video0  ZED-M") &&
                 EndsWith("  2560x720  YUYV  both eyes side by side  60, 30 fps\n"
                          "  exposure can be fixed, gain can be fixed\n"));
  CHECK_THAT(text_of(cameras[1]), EndsWith("   640x480  GREY  one eye                 30 fps\n"
                                           "  exposure cannot be fixed, gain cannot be fixed\n"));
  CHECK_THAT(text_of(cameras[2]), Contains("   640x360  Z16   depth                   90 fps\n"));
  CHECK_THAT(text_of(cameras[5]), Contains("   640x480  Y16   infrared, codes, depth  30 fps\n"));
  CHECK_THAT(cameras[3].trouble, Contains("/dev/video3"));
  CHECK(text_of(cameras[3]) == cameras[3].trouble + "\n");
  CHECK_THAT(text_of(cameras[4]),
             StartsWith("/dev/video4  Odd") && EndsWith("  no picture format that can be read\n"));
  CHECK(cameras[0].calibration.empty());
  CHECK(video.opened == 0);
}

TEST_CASE("the calibration that a camera of two eyes would be opened with is named",
          "[sources][camera]") {
  test::FakeVideo video = one_of_each();
  const test::ScratchFolder folder("camera_list");
  const std::filesystem::path file = folder.path() / "zed-m-1280x720.yml";
  std::ofstream(file) << "%YAML:1.0\n";
  const std::vector<ListedCamera> cameras = list_cameras(video, {folder.path()});
  CHECK(cameras[0].calibration == file);
  CHECK(cameras[1].calibration.empty());
  const Json listed = json_of(cameras);
  CHECK(listed["cameras"][0]["calibration"].get<std::string>() == file.string());
}

TEST_CASE("the list knows a camera of several devices, and what may disturb it",
          "[sources][camera]") {
  test::FakeVideo video;
  video.cameras = {device("/dev/video0", "RealSense", {{kDepth, 848, 480, {90}}}),
                   device("/dev/video1", "RealSense", {}),
                   device("/dev/video2", "RealSense",
                          {{kGrey, 848, 100, {100}}, {four_letters("Y8I "), 848, 480, {90}}}),
                   device("/dev/video4", "RealSense", {{kYuyv, 848, 480, {60}}}),
                   device("/dev/video6", "Webcam", {{kGrey, 640, 480, {30}}})};
  for (int i = 0; i < 4; ++i) video.cameras[i].bus = "usb-1";
  video.cameras[1].capabilities = V4L2_CAP_META_CAPTURE | V4L2_CAP_STREAMING;
  video.cameras[0].usb = {480, 2.1};
  video.cameras[2].usb = {5000, 3.2};
  video.cameras[4].controls = {{V4L2_CID_EXPOSURE_AUTO_PRIORITY, 1}};
  video.cameras[4].users = "cheese (process 4711)";
  const std::vector<ListedCamera> cameras = list_cameras(video, {});
  CHECK(cameras[0].kind == CameraKind::kDepth);
  CHECK(cameras[0].pictures == "/dev/video2");  // the infrared, which has the depth's view
  CHECK(cameras[1].is_data);
  CHECK(cameras[2].kind == CameraKind::kInterleaved);
  CHECK_FALSE(cameras[2].is_data);
  CHECK_THAT(text_of(cameras[0]), Contains("USB: 480 Mbit/s; it is plugged into a USB 2 port"));
  CHECK_THAT(text_of(cameras[2]), Contains("Y8I   both eyes interleaved") && Contains("one eye") &&
                                      EndsWith("  USB: 5000 Mbit/s\n"));
  CHECK_THAT(text_of(cameras[4]), Contains("exposure_dynamic_framerate") &&
                                      EndsWith("  opened by cheese (process 4711)\n"));
  CHECK_THAT(text_of(cameras[3]), !Contains("exposure_dynamic_framerate") && !Contains("opened"));
  const Json listed = json_of(cameras)["cameras"];
  CHECK(listed[0]["usb_megabits"].get<double>() == 480);
  CHECK(listed[4]["usb_megabits"].is_null());
  CHECK(listed[4]["may_slow_down"].get<bool>());
  CHECK(listed[4]["users"].get<std::string>() == "cheese (process 4711)");
}

TEST_CASE("programs are told the same of the cameras", "[sources][camera]") {
  test::FakeVideo video = one_of_each();
  const Json listed = json_of(list_cameras(video, {}));
  const Json& cameras = listed["cameras"];
  REQUIRE(cameras.size() == 6);
  CHECK(cameras[0]["name"].get<std::string>() == "ZED-M");
  CHECK(cameras[0]["exposure"].get<bool>());
  CHECK(cameras[0]["calibration"].is_null());
  CHECK(cameras[0]["modes"].dump() ==
        R"([{"width":2560,"height":720,"format":"YUYV","kind":"both eyes side by side",)"
        R"("fps":[60.0,30.0]}])");
  CHECK_FALSE(cameras[1]["gain"].get<bool>());
  CHECK(cameras[2]["modes"][0]["kind"].get<std::string>() == "depth");
  CHECK_THAT(cameras[3]["trouble"].get<std::string>(), Contains("/dev/video3"));
  CHECK_FALSE(cameras[3].contains("name"));
  CHECK(cameras[4]["modes"].size() == 0);
  test::FakeVideo none;
  CHECK(json_of(list_cameras(none, {})).dump() == R"({"cameras":[]})");
}

// Sets an environment variable, or removes it, until the end of the scope.
class Variable {
 public:
  Variable(const char* name, const char* value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    value != nullptr ? ::setenv(name, value, 1) : ::unsetenv(name);
  }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;
  ~Variable() { before_ ? ::setenv(name_, before_->c_str(), 1) : ::unsetenv(name_); }

 private:
  const char* name_;
  std::optional<std::string> before_;
};

TEST_CASE("calibrations are kept where the user's settings are, a ZED's own are looked for after",
          "[sources][camera]") {
  using Folders = std::vector<std::filesystem::path>;
  const Variable home("HOME", "/home/ada");
  {
    const Variable config("XDG_CONFIG_HOME", "/etc/ada");
    CHECK(calibration_folders() == Folders{"/etc/ada/palpable", "/usr/local/zed/settings"});
  }
  for (const char* unset : {static_cast<const char*>(nullptr), ""}) {
    const Variable config("XDG_CONFIG_HOME", unset);
    CHECK(calibration_folders() ==
          Folders{"/home/ada/.config/palpable", "/usr/local/zed/settings"});
  }
  const Variable config("XDG_CONFIG_HOME", nullptr);
  const Variable no_home("HOME", nullptr);
  CHECK(calibration_folders() == Folders{"/usr/local/zed/settings"});
}

}  // namespace
}  // namespace palpable

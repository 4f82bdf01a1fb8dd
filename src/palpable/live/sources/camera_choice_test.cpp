// A camera of several devices, as a RealSense D435 is, made of code.
#include "palpable/live/sources/camera_choice.h"

#include "palpable/live/calibrate/calibration_file.h"
#include "palpable/live/sources/camera_source.h"
#include "tests/support/camera_request.h"
#include "tests/support/fake_video.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace palpable {
namespace {

using Catch::Matchers::Contains;
using test::FakeDevice;
using test::FakeVideo;
using test::ScratchFolder;

constexpr std::uint32_t kY8i = four_letters("Y8I ");
constexpr std::uint32_t kY12i = four_letters("Y12I");
constexpr std::uint32_t kZ16 = four_letters("Z16 ");
constexpr std::uint32_t kGrey = four_letters("GREY");
constexpr std::uint32_t kYuyv = four_letters("YUYV");
constexpr int kWidth = 32;  // px
constexpr int kHeight = 20;
constexpr std::size_t kPixels = kWidth * kHeight;

FakeDevice device(const char* path, std::vector<test::FakeMode> modes) {
  FakeDevice camera;
  camera.path = path;
  camera.card = "Intel(R) RealSense(TM) Depth Ca";
  camera.product = "Intel(R) RealSense(TM) Depth Camera 435";
  camera.bus = "usb-0000:00:14.0-1";
  camera.modes = std::move(modes);
  return camera;
}

// Depth, infrared and colour, each followed by a device for data. The numbers are not those of the
// manual: they change from one start of the machine to the next.
FakeVideo realsense() {
  FakeVideo video;
  FakeDevice data = device("/dev/video3", {});
  data.capabilities = V4L2_CAP_META_CAPTURE | V4L2_CAP_STREAMING;
  FakeDevice data_of_color = data;
  data_of_color.path = "/dev/video5";
  FakeDevice webcam = device("/dev/video0", {{kYuyv, kWidth, kHeight, {30}}});
  webcam.card = "Laptop";
  webcam.bus = "usb-0000:00:14.0-7";
  video.cameras = {webcam,
                   device("/dev/video2", {{kGrey, 848, 100, {100}},
                                          {kGrey, kWidth, kHeight, {30}},
                                          {kY12i, 1280, 800, {25}},
                                          {kY8i, 16, kHeight, {90}},
                                          {kY8i, kWidth, kHeight, {30}}}),
                   data,
                   device("/dev/video4", {{kYuyv, kWidth, kHeight, {30}}}),
                   data_of_color,
                   device("/dev/video6", {{kZ16, kWidth, kHeight, {30}}})};
  return video;
}

FakeDevice& at(FakeVideo& video, const std::string& path) {
  return *std::find_if(video.cameras.begin(), video.cameras.end(),
                       [&](const FakeDevice& camera) { return camera.path == path; });
}

CameraRequest depth_request(const ScratchFolder& folder, const char* path, const char* depth) {
  CameraRequest wanted;
  wanted.device = path;
  wanted.depth = depth;
  wanted.calibration = folder / "intrinsics.txt";
  test::write_bytes(wanted.calibration, "30 30 16 10 32 20");
  return wanted;
}

TEST_CASE("both eyes interleaved are a stereo source, also with a calibration",
          "[sources][camera]") {
  FakeVideo video = realsense();
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i < kPixels; ++i) {
    bytes.push_back(static_cast<std::uint8_t>(i % kWidth));  // left: the column
    bytes.push_back(200);
  }
  for (int i = 0; i < 3; ++i) {
    at(video, "/dev/video2").shots.push_back({100.1 + i / 30.0, bytes});
  }
  {
    const auto source = value_or_throw(open_camera(test::camera_request("/dev/video2"), video));
    CHECK(source->format().kind == FrameFormat::Kind::kStereo);
    CHECK((source->format().width == kWidth && source->format().height == kHeight));
    Frame frame;
    FrameStatus status = source->next(frame);
    if (status == FrameStatus::kWaiting) status = source->next(frame);
    REQUIRE(status == FrameStatus::kFrame);
    CHECK(frame.both.empty());
    REQUIRE((frame.left.width() == kWidth && frame.left.height() == kHeight));
    CHECK(frame.left(5, 3).g == 5);
    CHECK(frame.left(31, 9).r == 31);
    CHECK(frame.right(31, 9).b == 200);
  }

  // The smaller size, of one eye as the camera states it.
  CameraRequest wanted = test::camera_request("/dev/video2");
  wanted.width = 16;
  wanted.height = kHeight;
  CHECK(value_or_throw(open_camera(wanted, video))->format().width == 16);
  wanted.width = 48;
  CHECK_THAT(test::camera_refusal(video, wanted), Contains("has no pictures of 48x20 px; it has"));

  const ScratchFolder folder("camera_interleaved");
  StereoCalibration calibration;
  calibration.rig.left.pinhole = calibration.rig.right.pinhole = {kWidth, kHeight, 30, 30, 16, 10};
  calibration.rig.right_from_left.translation().x() = -0.05;
  wanted = test::camera_request("/dev/video2");
  wanted.without_calibration = false;
  wanted.folders = {folder.path()};
  CHECK_THAT(test::camera_refusal(video, wanted),
             Contains("no calibration is known") && Contains("32x20 px"));
  write_stereo_calibration(
      folder / calibration_name("Intel(R) RealSense(TM) Depth Ca", kWidth, kHeight), calibration);
  CHECK(value_or_throw(open_camera(wanted, video))->format().rig.left == calibration.rig.left);
}

TEST_CASE("Y12I holds the eyes as the kernel says, and a RealSense's as librealsense says",
          "[sources][camera]") {
  // One pixel: low 12 bits 0x123, high 12 bits 0xABC.
  const std::vector<std::uint8_t> pixel{0x23, 0xC1, 0xAB};
  RawPicture raw{kY12i, 1, 1, 3, pixel.data(), pixel.size()};
  ColorImage left, right;
  REQUIRE(to_eyes(raw, left, right).empty());
  CHECK(left(0, 0).r == 0x12);  // 12 bits to 8
  CHECK(right(0, 0).r == 0xAB);
  // Ten bits: 0x123 and, in the high ones, 0x2BC.
  const std::vector<std::uint8_t> ten{0x23, 0xC1, 0x2B};
  raw = {kY12i, 1, 1, 3, ten.data(), ten.size(), true};
  REQUIRE(to_eyes(raw, left, right).empty());
  CHECK(right(0, 0).g == 0x123 >> 2);
  CHECK(left(0, 0).g == 0x2BC >> 2);
  raw.data = pixel.data();  // more than ten bits: white
  REQUIRE(to_eyes(raw, left, right).empty());
  CHECK(left(0, 0).b == 255);

  raw.size = 2;
  CHECK_THAT(to_eyes(raw, left, right), Contains("2 of 3 bytes"));
  raw = {kY8i, 2, 1, 2, pixel.data(), pixel.size()};
  CHECK_THAT(to_eyes(raw, left, right), Contains("a row has 2 bytes; 2 px have 4"));
  raw = {kGrey, 1, 1, 3, pixel.data(), pixel.size()};
  CHECK_THAT(to_eyes(raw, left, right), Contains("no two eyes in GREY"));

  // Rows longer than their pixels.
  const std::vector<std::uint8_t> rows{1, 2, 0, 0, 3, 4, 0, 0};
  raw = {kY8i, 1, 2, 4, rows.data(), rows.size()};
  REQUIRE(to_eyes(raw, left, right).empty());
  CHECK((left(0, 1).r == 3 && right(0, 1).r == 4));

  // A camera opens in Y12I, by the name that it has.
  for (const bool by_realsense : {true, false}) {
    INFO(by_realsense);
    FakeVideo video;
    video.cameras = {device("/dev/video0", {{kY12i, kWidth, kHeight, {30}}})};
    if (!by_realsense) video.cameras[0].card = "Twin";
    std::vector<std::uint8_t> bytes;
    for (std::size_t i = 0; i < kPixels; ++i) bytes.insert(bytes.end(), ten.begin(), ten.end());
    video.cameras[0].shots.push_back({100.05, bytes});
    const auto source = value_or_throw(open_camera(test::camera_request("/dev/video0"), video));
    Frame frame;
    REQUIRE(source->next(frame) == FrameStatus::kFrame);
    CHECK(frame.left(7, 7).r == (by_realsense ? 0x2BC >> 2 : 0x123 >> 4));
    CHECK(frame.right(7, 7).r == (by_realsense ? 0x123 >> 2 : 0x2BC >> 4));
  }
}

TEST_CASE("a strip of one eye is not taken for two eyes side by side", "[sources][camera]") {
  FakeVideo video = realsense();
  const CameraInfo infrared = value_or_throw(query_camera(video, "/dev/video2"));
  CHECK(side_by_side_mode(infrared) == nullptr);
  const std::optional<EyeSize> eye = size_of_two_eyes(infrared);
  REQUIRE(eye);
  CHECK((eye->width == kWidth && eye->height == kHeight));  // of Y8I, not the larger Y12I
  CHECK(is_side_by_side({kYuyv, 2560, 720, {}}));
  CHECK(is_side_by_side({kYuyv, 2482, 376, {}}));  // two eyes of KITTI
  CHECK_FALSE(is_side_by_side({kY8i, 2560, 720, {}}));
  CHECK_FALSE(size_of_two_eyes(value_or_throw(query_camera(video, "/dev/video4"))));
}

TEST_CASE("the depth device is known by its formats, whatever its number", "[sources][camera]") {
  const ScratchFolder folder("camera_nodes");
  struct Named {
    const char* depth;
    std::string note;
  };
  for (const Named& named : {Named{"/dev/video6", ""}, Named{"auto", "the depth comes from"},
                             Named{"/dev/video4", "/dev/video4 gives no depth"},
                             Named{"/dev/video3", "/dev/video3 gives no depth"}}) {
    INFO(named.depth);
    FakeVideo video = realsense();
    std::vector<std::uint8_t> depths;
    for (std::size_t i = 0; i < kPixels; ++i) {
      depths.push_back(0xF4);  // 500 mm
      depths.push_back(0x01);
    }
    at(video, "/dev/video2").shots.push_back({100.1, std::vector<std::uint8_t>(kPixels, 9)});
    at(video, "/dev/video6").shots.push_back({100.1, depths});
    const auto source =
        value_or_throw(open_camera(depth_request(folder, "/dev/video2", named.depth), video));
    const std::vector<std::string> notes = source->take_notes();
    REQUIRE(notes.size() == (named.note.empty() ? 1 : 2));  // the last one is of the unit
    if (!named.note.empty()) {
      CHECK_THAT(notes[0], Contains(named.note) && Contains("from /dev/video6"));
    }
    CHECK_THAT(notes.back(), Contains("as known of Intel(R) RealSense(TM) Depth Camera 435"));
    Frame frame;
    FrameStatus status = source->next(frame);
    if (status == FrameStatus::kWaiting) status = source->next(frame);
    REQUIRE(status == FrameStatus::kFrame);
    CHECK(frame.left(3, 3).r == 9);
    CHECK(frame.depth(3, 3) == Approx(0.5));
  }
}

TEST_CASE("a driver that offers all sizes and rates between two gives the one that is asked for",
          "[sources][camera]") {
  FakeVideo video;
  video.cameras = {device("/dev/video0", {{kGrey, 64, 20, {60, 1}, true}})};
  const CameraInfo info = value_or_throw(query_camera(video, "/dev/video0"));
  REQUIRE(info.modes.size() == 1);
  CHECK(info.modes[0].rates == std::vector<double>{60, 1});
  CHECK(has_size(info.modes[0], 40, 12));
  CHECK_FALSE(has_size(info.modes[0], 41, 12));
  CHECK_FALSE(has_size(info.modes[0], 30, 12));
  CHECK_FALSE(has_size(info.modes[0], 66, 12));
  CameraRequest wanted = test::camera_request("/dev/video0");
  wanted.width = 40;
  wanted.height = 12;
  wanted.frames_per_second = 25;
  {
    const auto source = value_or_throw(open_camera(wanted, video));
    CHECK((source->format().width == 20 && source->format().height == 12));
    CHECK(video.cameras[0].set_rate == Approx(25));
    CHECK(source->take_notes().empty());
  }
  CHECK(value_or_throw(open_camera(test::camera_request("/dev/video0"), video))->format().width ==
        32);
  CHECK(video.cameras[0].set_rate == Approx(60));
  wanted.width = 80;
  CHECK_THAT(test::camera_refusal(video, wanted), Contains("it has 32x2 to 64x20"));
}

TEST_CASE("a device without the wanted pictures is refused with the one that has them",
          "[sources][camera][refusal]") {
  const ScratchFolder folder("camera_wrong_nodes");
  FakeVideo video = realsense();
  // The depth device as the source.
  CHECK_THAT(test::camera_refusal(video, test::camera_request("/dev/video6")),
             Contains("gives depth or 16-bit grey") && Contains("--depth-source") &&
                 Contains("come from /dev/video2"));
  // One device for both.
  CHECK_THAT(test::camera_refusal(video, depth_request(folder, "/dev/video6", "/dev/video6")),
             Contains("/dev/video6 is named twice") && Contains("--depth-source needs another"));
  CHECK_THAT(
      test::camera_refusal(video, depth_request(folder, "/dev/video0", "/dev/../dev/video0")),
      Contains("named twice"));
  // Another camera, which has no depth.
  CHECK_THAT(test::camera_refusal(video, depth_request(folder, "/dev/video2", "/dev/video0")),
             Contains("/dev/video0 (Laptop) gives no depth"));
  CHECK_THAT(test::camera_refusal(video, depth_request(folder, "/dev/video0", "auto")),
             Contains("--depth-source auto: no device of the camera /dev/video0 (Laptop)"));
  CHECK_THAT(test::camera_refusal(video, test::camera_request("/dev/video3")),
             Contains("gives no pictures"));
  // Only interleaved, and a right eye.
  at(video, "/dev/video2").modes = {{kY8i, kWidth, kHeight, {30}}};
  CameraRequest wanted = test::camera_request("/dev/video2");
  wanted.right = "/dev/video4";
  CHECK_THAT(test::camera_refusal(video, wanted), Contains("both eyes in one picture (Y8I, Y12I)"));
}

}  // namespace
}  // namespace palpable

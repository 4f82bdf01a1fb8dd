#include "palpable/live/sources/camera_source.h"

#include "palpable/live/calibrate/calibration_file.h"
#include "palpable/live/sources/camera_choice.h"
#include "palpable/live/sources/source_guard.h"
#include "tests/support/camera_request.h"
#include "tests/support/fake_video.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <opencv2/imgcodecs.hpp>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using test::FakeDevice;
using test::FakeVideo;
using test::ScratchFolder;

constexpr std::uint32_t kYuyv = four_letters("YUYV");
constexpr std::uint32_t kGrey = four_letters("GREY");
constexpr std::uint32_t kDepth = four_letters("Z16 ");
constexpr int kWidth = 32;  // px, one eye
constexpr int kHeight = 10;

// A stereo camera that sends both eyes in one picture; all pixels of picture i have grey level i.
FakeDevice stereo_camera() {
  FakeDevice camera;
  camera.path = "/dev/video0";
  camera.card = "ZED-M: test";
  camera.modes = {{kGrey, 2 * kWidth, kHeight, {30}}, {kGrey, kWidth, kHeight, {30}}};
  return camera;
}

constexpr std::size_t kBoth = 2 * kWidth * kHeight;
constexpr std::size_t kOne = kWidth * kHeight;

bool contains(const std::string& text, const std::string& part) {
  UNSCOPED_INFO(text);
  return text.find(part) != std::string::npos;
}

TEST_CASE("a stereo camera's pictures come as pairs with the driver's times", "[sources][camera]") {
  FakeVideo video;
  video.cameras = {stereo_camera()};
  // The eyes differ: the left half of each row is 10 + i, the right half 100 + i.
  for (int i = 0; i < 5; ++i) {
    std::vector<std::uint8_t> bytes(kBoth);
    for (std::size_t k = 0; k < kBoth; ++k) {
      bytes[k] = static_cast<std::uint8_t>((k % (2 * kWidth) < kWidth ? 10 : 100) + i);
    }
    video.cameras[0].shots.push_back({100.5 + i / 60.0, bytes});
  }
  {
    const auto source = value_or_throw(open_camera(test::camera_request(), video));
    CHECK(source->is_live());
    CHECK(source->frame_count() == -1);
    CHECK((source->format().width == kWidth && source->format().height == kHeight));
    Frame frame;
    int waits = 0;
    while (source->next(frame) == FrameStatus::kWaiting) ++waits;
    CHECK(waits <= 5);  // the first picture comes after half a second
    for (int i = 0; i < 5; ++i) {
      INFO(i);
      if (i > 0) REQUIRE(source->next(frame) == FrameStatus::kFrame);
      CHECK(frame.number == i);
      CHECK(frame.time == Approx(i / 60.0).margin(1e-5));
      CHECK(source->taken().value() == Approx(100.5 + i / 60.0).margin(1e-5));
      CHECK(frame.left ==
            ColorImage(kWidth, kHeight,
                       Rgb{static_cast<std::uint8_t>(10 + i), static_cast<std::uint8_t>(10 + i),
                           static_cast<std::uint8_t>(10 + i)}));
      CHECK(frame.right(0, 0).g == 100 + i);
    }
    CHECK(video.mapped == 4);
  }
  CHECK(video.opened == 0);
  CHECK(video.mapped == 0);
}

// A request with a calibration file, which is written into the folder.
CameraRequest calibrated_request(const fs::path& folder) {
  StereoCalibration calibration;
  calibration.rig.left.pinhole = calibration.rig.right.pinhole = {kWidth, kHeight, 30, 30, 16, 5};
  calibration.rig.right_from_left.translation().x() = -0.06;
  CameraRequest wanted = test::camera_request();
  wanted.without_calibration = false;
  wanted.calibration = folder / "calibration.yml";
  write_stereo_calibration(wanted.calibration, calibration);
  return wanted;
}

TEST_CASE("a calibrated camera's YUYV is handed over as it is", "[sources][camera]") {
  const ScratchFolder scratch("camera_yuyv");
  const CameraRequest wanted = calibrated_request(scratch.path());
  FakeVideo video;
  video.cameras = {stereo_camera()};
  video.cameras[0].modes = {{kYuyv, 2 * kWidth, kHeight, {30}}};
  std::vector<std::uint8_t> bytes(2 * kBoth);
  for (std::size_t k = 0; k < bytes.size(); ++k) bytes[k] = static_cast<std::uint8_t>(k % 251);
  for (int i = 0; i < 3; ++i) video.cameras[0].shots.push_back({100 + i / 30.0, bytes});
  video.cameras[0].shots[1].bytes.resize(bytes.size() - 1);
  const auto source = value_or_throw(open_camera(wanted, video));
  SourceGuard guard(*source);
  Frame frame;
  for (const FrameStatus status :
       {FrameStatus::kFrame, FrameStatus::kUnreadable, FrameStatus::kFrame}) {
    REQUIRE(guard.next(frame) == status);
    if (status != FrameStatus::kFrame) continue;
    REQUIRE((frame.both.width() == kWidth && frame.both.height() == kHeight));
    CHECK(std::memcmp(frame.both.data(), bytes.data(), bytes.size()) == 0);
    CHECK(frame.left.empty());
  }
  // The search for boards needs colours.
  FakeVideo again;
  again.cameras = {stereo_camera()};
  again.cameras[0].modes = {{kYuyv, 2 * kWidth, kHeight, {30}}};
  again.cameras[0].shots.push_back({100, bytes});
  const auto uncalibrated = value_or_throw(open_camera(test::camera_request(), again));
  REQUIRE(uncalibrated->next(frame) == FrameStatus::kFrame);
  CHECK(frame.left.width() == kWidth);
}

TEST_CASE("a camera that comes back with another format gives its new pictures",
          "[sources][camera]") {
  const ScratchFolder scratch("camera_other_format");
  FakeVideo video;
  video.cameras = {stereo_camera()};
  FakeDevice& camera = video.cameras[0];
  camera.modes = {{kYuyv, 2 * kWidth, kHeight, {30}}};
  camera.film(100.1, 5, 30, 2 * kBoth);
  camera.film(104, 20, 30, kBoth, 77);
  camera.gone_from = 101;
  camera.gone_until = 103;
  const auto source = value_or_throw(open_camera(calibrated_request(scratch.path()), video));
  SourceGuard guard(*source);
  Frame frame;
  int as_sent = 0, converted = 0;
  while (video.time < 105) {
    if (video.time > 102) camera.modes = {{kGrey, 2 * kWidth, kHeight, {30}}};
    if (guard.next(frame) != FrameStatus::kFrame) continue;
    if (video.time < 102) {
      CHECK_FALSE(frame.both.empty());
      ++as_sent;
    } else {
      CHECK(frame.both.empty());
      CHECK(frame.left.width() == kWidth);
      ++converted;
    }
  }
  CHECK(as_sent > 0);
  CHECK(converted > 0);
}

TEST_CASE("a late reader gets the newest picture, and what it missed counts as dropped",
          "[sources][camera]") {
  FakeVideo video;
  video.cameras = {stereo_camera()};
  video.cameras[0].film(100, 40, 60, kBoth, 0);
  const auto source = value_or_throw(open_camera(test::camera_request(), video));
  SourceGuard guard(*source);
  Frame frame;
  REQUIRE(guard.next(frame) == FrameStatus::kFrame);
  CHECK(frame.number == 0);
  video.time += 2.5 / 60;  // two pictures come
  REQUIRE(guard.next(frame) == FrameStatus::kFrame);
  CHECK(frame.number == 2);
  CHECK(frame.left(0, 0).r == 2);
  CHECK(guard.troubles().dropped == 1);
  // A gap longer than the driver's buffers: the kept picture is old, but there is no newer one.
  video.time += 0.5;
  REQUIRE(guard.next(frame) == FrameStatus::kFrame);
  const int kept = frame.number;
  REQUIRE(guard.next(frame) == FrameStatus::kFrame);
  CHECK(frame.number > 30);
  CHECK(frame.left(0, 0).r == frame.number);
  CHECK(guard.troubles().dropped == frame.number - 3 - (kept > 2 ? 0 : 1));
}

TEST_CASE("a camera that stalls, goes and comes back is followed through all of it",
          "[sources][camera]") {
  FakeVideo video;
  video.cameras = {stereo_camera()};
  FakeDevice& camera = video.cameras[0];
  camera.film(100.1, 5, 30, kBoth);
  camera.film(102, 5, 30, kBoth);
  camera.film(110, 50, 30, kBoth);
  camera.gone_from = 103;
  camera.gone_until = 108.5;
  const auto source = value_or_throw(open_camera(test::camera_request(), video));
  SourceGuard guard(*source);
  Frame frame;
  std::vector<std::string> reports;
  std::vector<int> numbers;
  while (video.time < 111) {
    const double before = video.time;
    if (guard.next(frame) == FrameStatus::kFrame) numbers.push_back(frame.number);
    CHECK(video.time - before <= 0.1001);  // next() never blocks longer than kLongestWait
    for (std::string& line : guard.take_reports()) reports.push_back(std::move(line));
  }
  CHECK(numbers.size() > 30);
  for (std::size_t i = 1; i < numbers.size(); ++i) CHECK(numbers[i] == numbers[i - 1] + 1);
  CHECK(guard.troubles().losses == 1);
  REQUIRE(reports.size() >= 5);
  CHECK(contains(reports[0], "no pictures after frame 4"));
  CHECK(contains(reports[1], "come again"));
  CHECK(contains(reports[2], "no pictures after frame 9"));
  CHECK(contains(reports[3], "gone after frame 9"));
  CHECK(contains(reports.back(), "come again"));
  CHECK(frame.time == Approx(video.time - 100.1).margin(0.05));
  CHECK(video.opened == 1);
  CHECK(video.mapped == 4);
}

TEST_CASE("torn and damaged pictures are left out, and the next one is good", "[sources][camera]") {
  FakeVideo video;
  video.cameras = {stereo_camera()};
  FakeDevice& camera = video.cameras[0];
  camera.film(100, 6, 30, kBoth);
  camera.shots[1].bytes.resize(kBoth / 2);
  camera.shots[3].flags = V4L2_BUF_FLAG_ERROR;
  const auto source = value_or_throw(open_camera(test::camera_request(), video));
  Frame frame;
  std::vector<FrameStatus> answers;
  for (int i = 0; i < 6; ++i) {
    answers.push_back(source->next(frame));
    CHECK(frame.number == i);
    if (i == 1) CHECK(contains(source->last_trouble(), "sent 320 of 640 bytes"));
    if (i == 3) CHECK(contains(source->last_trouble(), "damaged"));
  }
  using S = FrameStatus;
  CHECK(answers ==
        std::vector{S::kFrame, S::kUnreadable, S::kFrame, S::kUnreadable, S::kFrame, S::kFrame});
}

TEST_CASE("the pictures of two cameras are paired by their times", "[sources][camera]") {
  FakeVideo video;
  FakeDevice left = stereo_camera();
  left.modes = {{kGrey, kWidth, kHeight, {30}}};
  FakeDevice right = left;
  right.path = "/dev/video2";
  left.film(100, 20, 30, kOne, 0);
  right.film(100.012, 20, 30, kOne, 100);  // a third of a period later
  left.shots.erase(left.shots.begin() + 5, left.shots.begin() + 8);
  video.cameras = {left, right};
  CameraRequest wanted = test::camera_request();
  wanted.right = "/dev/video2";
  const auto source = value_or_throw(open_camera(wanted, video));
  Frame frame;
  int frames = 0;
  while (video.time < 100.9) {
    if (source->next(frame) != FrameStatus::kFrame) continue;
    ++frames;
    CHECK(frame.right(0, 0).r == 100 + frame.left(0, 0).r);
  }
  CHECK(frames >= 15);
}

TEST_CASE("two cameras whose pictures are never of one moment are stalled, and say why",
          "[sources][camera]") {
  FakeVideo video;
  FakeDevice left = stereo_camera();
  left.modes = {{kGrey, kWidth, kHeight, {30}}};
  FakeDevice right = left;
  right.path = "/dev/video2";
  left.film(100, 30, 10, kOne, 0);
  right.film(100.05, 30, 10, kOne, 100);  // 50 ms apart, 1.5 of the stated periods
  video.cameras = {left, right};
  CameraRequest wanted = test::camera_request();
  wanted.right = "/dev/video2";
  const auto source = value_or_throw(open_camera(wanted, video));
  Frame frame;
  while (video.time < 102) {
    const double before = video.time;
    CHECK(source->next(frame) == FrameStatus::kWaiting);
    CHECK(video.time - before <= 0.1001);
  }
  CHECK(source->state() == SourceState::kStalled);
  CHECK(contains(source->last_trouble(), "none of the same moment"));
}

TEST_CASE("a camera that comes back is held again as it was asked for", "[sources][camera]") {
  FakeVideo video;
  video.cameras = {stereo_camera()};
  FakeDevice& camera = video.cameras[0];
  const std::map<std::uint32_t, int> automatic{{V4L2_CID_EXPOSURE_AUTO, 3},
                                               {V4L2_CID_EXPOSURE_ABSOLUTE, 77}};
  camera.controls = automatic;
  camera.film(100, 60, 30, kBoth);
  camera.film(110, 60, 30, kBoth);
  camera.gone_from = 103;
  camera.gone_until = 108;
  CameraRequest wanted = test::camera_request();
  wanted.lock = true;
  const auto source = value_or_throw(open_camera(wanted, video));
  Frame frame;
  while (video.time < 105) static_cast<void>(source->next(frame));
  CHECK(source->state() == SourceState::kGone);
  CHECK(camera.controls[V4L2_CID_EXPOSURE_AUTO] == V4L2_EXPOSURE_MANUAL);
  camera.controls = automatic;  // the camera has lost power
  while (video.time < 110.9) static_cast<void>(source->next(frame));
  CHECK(camera.controls == automatic);
  while (video.time < 111.5) static_cast<void>(source->next(frame));
  CHECK(camera.controls[V4L2_CID_EXPOSURE_AUTO] == V4L2_EXPOSURE_MANUAL);
}

TEST_CASE("colour and depth of one view come as frames with depth in metres", "[sources][camera]") {
  const ScratchFolder folder("camera_depth");
  test::write_bytes(folder / "intrinsics.txt", "30 30 16 5 32 10 0.0001");
  FakeVideo video;
  FakeDevice infrared = stereo_camera();
  infrared.modes = {{kGrey, 64, 40, {30}}, {kGrey, kWidth, kHeight, {30}}};
  FakeDevice depth = infrared;
  depth.path = "/dev/video1";
  depth.modes = {{kDepth, kWidth, kHeight, {30}}};
  infrared.film(100, 3, 30, kOne, 50);
  for (int i = 0; i < 3; ++i) {
    std::vector<std::uint8_t> bytes(2 * kOne);
    for (std::size_t k = 0; k < kOne; ++k) {
      const unsigned step = k == 1 ? 0 : k == 2 ? 65535 : 4000 + 256U * static_cast<unsigned>(i);
      bytes[2 * k] = static_cast<std::uint8_t>(step);
      bytes[2 * k + 1] = static_cast<std::uint8_t>(step >> 8);
    }
    depth.shots.push_back({100.001 + i / 30.0, bytes});
  }
  video.cameras = {infrared, depth};
  CameraRequest wanted;
  wanted.device = "/dev/video0";
  wanted.depth = "/dev/video1";
  CHECK(contains(test::camera_refusal(video, wanted), "--calibration (intrinsics.txt)"));
  wanted.calibration = folder / "intrinsics.txt";
  const auto source = value_or_throw(open_camera(wanted, video));
  CHECK(source->format().kind == FrameFormat::Kind::kColorDepth);
  Frame frame;
  for (int i = 0; i < 3; ++i) {
    REQUIRE(source->next(frame) == FrameStatus::kFrame);
    CHECK(frame.left(0, 0).r == 50 + i);
    CHECK(frame.depth(0, 0) == Approx(0.4 + 0.0256 * i));
    CHECK(std::isnan(frame.depth(1, 0)));
    CHECK(std::isnan(frame.depth(2, 0)));
  }
}

TEST_CASE("exposure and gain are set, or held as the camera has found them", "[sources][camera]") {
  FakeVideo video;
  video.cameras = {stereo_camera()};
  auto& controls = video.cameras[0].controls;
  const std::map<std::uint32_t, int> automatic{{V4L2_CID_EXPOSURE_AUTO, 3},
                                               {V4L2_CID_EXPOSURE_ABSOLUTE, 77},
                                               {V4L2_CID_GAIN, 5},
                                               {V4L2_CID_AUTO_WHITE_BALANCE, 1}};
  controls = automatic;
  CameraRequest wanted = test::camera_request();
  wanted.exposure_ms = 8.0;
  wanted.gain = 20;
  CHECK(open_camera(wanted, video).ok());
  CHECK(controls[V4L2_CID_EXPOSURE_AUTO] == V4L2_EXPOSURE_MANUAL);
  CHECK(controls[V4L2_CID_EXPOSURE_ABSOLUTE] == 80);
  CHECK(controls[V4L2_CID_GAIN] == 20);

  controls = automatic;
  video.cameras[0].film(100, 45, 30, kBoth);
  wanted = test::camera_request();
  wanted.lock = true;
  const auto source = value_or_throw(open_camera(wanted, video));
  Frame frame;
  for (int i = 0; i < 30; ++i) REQUIRE(source->next(frame) == FrameStatus::kFrame);
  CHECK(controls == automatic);
  controls[V4L2_CID_EXPOSURE_ABSOLUTE] = 91;  // changed by the camera's automatic exposure
  for (int i = 0; i < 5; ++i) REQUIRE(source->next(frame) == FrameStatus::kFrame);
  CHECK(controls[V4L2_CID_EXPOSURE_AUTO] == V4L2_EXPOSURE_MANUAL);
  CHECK(controls[V4L2_CID_EXPOSURE_ABSOLUTE] == 91);
  CHECK(controls[V4L2_CID_AUTO_WHITE_BALANCE] == 0);
  CHECK(source->take_notes().empty());

  // A value that cannot be locked is reported once, and the others are locked.
  controls = {{V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_APERTURE_PRIORITY},
              {V4L2_CID_EXPOSURE_ABSOLUTE, 50}};
  video.cameras[0].film(video.time + 1, 45, 30, kBoth);
  const auto poor = value_or_throw(open_camera(wanted, video));
  for (int i = 0; i < 45; ++i) static_cast<void>(poor->next(frame));
  CHECK(controls[V4L2_CID_EXPOSURE_AUTO] == V4L2_EXPOSURE_MANUAL);
  CHECK(poor->take_notes() ==
        std::vector<std::string>{"the camera does not lock: gain, white balance"});

  controls.clear();
  wanted = test::camera_request();
  wanted.exposure_ms = 8.0;
  FakeVideo other;
  other.cameras = {stereo_camera()};
  CHECK(contains(test::camera_refusal(other, wanted), "has no exposure that can be set"));
  wanted.exposure_ms.reset();
  wanted.gain = 1;
  CHECK(contains(test::camera_refusal(other, wanted), "has no gain that can be set"));
  wanted = test::camera_request();
  wanted.lock = true;
  CHECK(contains(test::camera_refusal(other, wanted),
                 "neither exposure nor gain that can be locked"));
}

TEST_CASE("what a camera can do is asked for, size by size", "[sources][camera]") {
  FakeVideo video;
  video.cameras = {stereo_camera()};
  FakeDevice& camera = video.cameras[0];
  camera.modes = {{kYuyv, 1344, 376, {100, 60, 30, 15}},
                  {kYuyv, 2560, 720, {60, 30, 15}},
                  {kYuyv, 4416, 1242, {15}},
                  {four_letters("H264"), 1920, 1080, {30}}};
  camera.controls = {{V4L2_CID_GAIN, 5}};
  const CameraInfo info = value_or_throw(query_camera(video, "/dev/video0"));
  CHECK(info.name == "ZED-M: test");
  REQUIRE(info.modes.size() == 3);  // H264 cannot be converted and is not listed
  CHECK(info.modes[0].rates == std::vector<double>{100, 60, 30, 15});
  CHECK(info.has_gain);
  CHECK_FALSE(info.has_exposure);
  REQUIRE(side_by_side_mode(info) != nullptr);
  CHECK(side_by_side_mode(info)->width == 2560);
  CameraInfo small = info;
  small.modes.erase(small.modes.begin() + 1);
  CHECK(side_by_side_mode(small)->width == 1344);
  small.modes = {{kYuyv, 1920, 1080, {30}}};
  CHECK(side_by_side_mode(small) == nullptr);
}

TEST_CASE("a calibration is known by the camera's name and size, or by the ZED's own file",
          "[sources][camera]") {
  const ScratchFolder folder("camera_known");
  CHECK(calibration_name("ZED-M: ZED-M", 1280, 720) == "zed-m-zed-m-1280x720.yml");
  CHECK(calibration_name("::", 1, 2) == "camera-1x2.yml");
  const std::vector<fs::path> folders{folder / "none", folder.path()};
  CHECK_FALSE(known_calibration("ZED-M", 1280, 720, folders));
  test::write_bytes(folder / "SN1.conf", "x");
  CHECK(known_calibration("ZED-M", 1280, 720, folders) == folder / "SN1.conf");
  CHECK_FALSE(known_calibration("Other", 1280, 720, folders));
  test::write_bytes(folder / "SN2.conf", "x");
  CHECK_FALSE(known_calibration("ZED-M", 1280, 720, folders));
  test::write_bytes(folder / "zed-m-1280x720.yml", "x");
  CHECK(known_calibration("ZED-M", 1280, 720, folders) == folder / "zed-m-1280x720.yml");
  CHECK_FALSE(known_calibration("ZED-M", 672, 376, folders));

  // The camera is opened with this file.
  StereoCalibration calibration;
  calibration.rig.left.pinhole = calibration.rig.right.pinhole = {kWidth, kHeight, 30, 30, 16, 5};
  calibration.rig.right_from_left.translation().x() = -0.06;
  write_stereo_calibration(folder / calibration_name("ZED-M: test", kWidth, kHeight), calibration);
  FakeVideo video;
  video.cameras = {stereo_camera()};
  CameraRequest wanted;
  wanted.device = "/dev/video0";
  wanted.folders = folders;
  CHECK(value_or_throw(open_camera(wanted, video))->format().rig.left == calibration.rig.left);
}

TEST_CASE("a camera that cannot be used says why and what to do", "[sources][camera][refusal]") {
  const ScratchFolder folder("camera_refusals");
  FakeVideo video;
  video.cameras = {stereo_camera()};
  FakeDevice& camera = video.cameras[0];
  CameraRequest wanted = test::camera_request();

  camera.open_error = EACCES;
  CHECK(contains(test::camera_refusal(video, wanted), "usermod -aG video"));
  camera.open_error = EBUSY;
  CHECK(contains(test::camera_refusal(video, wanted), "another program is using it"));
  camera.open_error = 0;
  wanted.device = "/dev/video7";
  CHECK(contains(test::camera_refusal(video, wanted),
                 "there is no camera /dev/video7: palpable cameras"));
  wanted.device = "/dev/video0";
  camera.capabilities = V4L2_CAP_META_CAPTURE | V4L2_CAP_STREAMING;
  CHECK(contains(test::camera_refusal(video, wanted), "gives no pictures"));
  camera.capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;

  wanted.without_calibration = false;
  CHECK(contains(test::camera_refusal(video, wanted), "no calibration is known of /dev/video0"));
  write_rectified_calibration(folder / "r.yml", {{{64, 40, 30, 30, 16, 5}, 0.06, 0}, 30});
  wanted.calibration = folder / "r.yml";
  CHECK(contains(test::camera_refusal(video, wanted),
                 "/dev/video0 has no pictures of 128x40 px; it has 64x10, 32x10"));
  wanted.width = 2 * kWidth;
  wanted.height = kHeight;
  CHECK(contains(test::camera_refusal(video, wanted), "is for eyes of 64x40 px, not 32x10"));
  test::write_bytes(folder / "i.txt", "30 30 16 5");
  wanted.calibration = folder / "i.txt";
  CHECK(contains(test::camera_refusal(video, wanted), "is no calibration of a stereo rig"));

  camera.modes = {{kGrey, 16, kHeight, {30}}};
  CHECK(contains(test::camera_refusal(video, test::camera_request()),
                 "one eye's pictures only: name the other eye's camera"));
  wanted = test::camera_request();
  wanted.right = "/dev/video0";
  CHECK(contains(test::camera_refusal(video, wanted), "/dev/video0 is named twice"));
  wanted.right = "/dev/video1";
  FakeDevice depth = camera;
  depth.path = "/dev/video1";
  depth.modes = {{kDepth, 16, kHeight, {30}}};
  video.cameras.push_back(depth);
  CHECK(contains(test::camera_refusal(video, wanted), "no picture size in common"));
}

TEST_CASE("raw pictures become the colours that they hold", "[sources][camera]") {
  ColorImage image;
  // Two pixels of YUYV: luma 81 and 145 of a red (BT.601: Y 81, U 90, V 240).
  const std::vector<std::uint8_t> yuyv{81, 90, 145, 240};
  RawPicture raw{kYuyv, 2, 1, 4, yuyv.data(), yuyv.size()};
  REQUIRE(to_color(raw, image).empty());
  CHECK((image.width() == 2 && image.height() == 1));
  CHECK((image(0, 0).r >= 253 && image(0, 0).g <= 2 && image(0, 0).b <= 2));
  const std::vector<std::uint8_t> uyvy{90, 81, 240, 145};
  ColorImage other;
  raw = {four_letters("UYVY"), 2, 1, 4, uyvy.data(), uyvy.size()};
  REQUIRE(to_color(raw, other).empty());
  CHECK(other == image);
  const std::vector<std::uint8_t> bgr{1, 2, 3, 4, 5, 6};
  raw = {four_letters("BGR3"), 2, 1, 6, bgr.data(), bgr.size()};
  REQUIRE(to_color(raw, image).empty());
  CHECK((image(0, 0).r == 3 && image(1, 0).b == 4));
  raw.format = four_letters("RGB3");
  REQUIRE(to_color(raw, image).empty());
  CHECK((image(0, 0).r == 1 && image(1, 0).b == 6));
  const std::vector<std::uint8_t> nv12{100, 100, 100, 100, 128, 128};
  raw = {four_letters("NV12"), 2, 2, 2, nv12.data(), nv12.size()};
  REQUIRE(to_color(raw, image).empty());
  CHECK(image.height() == 2);
  CHECK(image(1, 1).r == image(0, 0).b);  // grey

  std::vector<std::uint8_t> jpeg;
  cv::imencode(".jpg", cv::Mat(16, 16, CV_8UC3, cv::Scalar(10, 20, 200)), jpeg);
  raw = {four_letters("MJPG"), 16, 16, 0, jpeg.data(), jpeg.size()};
  REQUIRE(to_color(raw, image).empty());
  CHECK((image.width() == 16 && image(8, 8).r > 190 && image(8, 8).b < 20));
  raw.size = jpeg.size() / 2;
  CHECK(contains(to_color(raw, image), "cut off"));
  raw = {four_letters("MJPG"), 16, 16, 0, bgr.data(), bgr.size()};
  CHECK(contains(to_color(raw, image), "no JPEG"));
  raw.format = four_letters("H264");
  CHECK(contains(to_color(raw, image), "no picture in H264"));
  raw = {kYuyv, 2, 2, 4, yuyv.data(), yuyv.size()};
  CHECK(contains(to_color(raw, image), "4 of 8 bytes"));
  raw = {kYuyv, 2, 2, 2, yuyv.data(), yuyv.size()};
  CHECK(contains(to_color(raw, image), "a row has 2 bytes; 2 px have 4"));
  DepthImage depth;
  raw.format = kDepth;
  CHECK(contains(to_depth(raw, 1e-3, depth), "a row has 2 bytes; 2 px have 4"));
  // A header that declares a gigapixel is rejected.
  raw = {four_letters("MJPG"), 16, 16, 0, jpeg.data(), jpeg.size()};
  const std::array<std::uint8_t, 2> frame_header{0xFF, 0xC0};
  const auto at = std::search(jpeg.begin(), jpeg.end(), frame_header.begin(), frame_header.end());
  REQUIRE(at != jpeg.end());
  at[5] = at[7] = 0x80;
  CHECK(contains(to_color(raw, image), "says it has 32784 x 32784 px, not 16 x 16"));
}

}  // namespace
}  // namespace palpable

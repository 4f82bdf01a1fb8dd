// What real cameras and their drivers do, with a camera made of code.
#include "palpable/live/sources/camera_source.h"
#include "palpable/live/sources/source_guard.h"
#include "tests/support/camera_request.h"
#include "tests/support/fake_video.h"
#include "tests/support/test.h"

#include <cerrno>
#include <memory>
#include <string>
#include <vector>

namespace palpable {
namespace {

using Catch::Matchers::Contains;
using test::FakeDevice;
using test::FakeVideo;

constexpr std::uint32_t kYuyv = four_letters("YUYV");
constexpr std::uint32_t kGrey = four_letters("GREY");
constexpr int kWidth = 32;  // px, one eye
constexpr int kHeight = 10;
constexpr std::size_t kBoth = 2 * kWidth * kHeight;

// A camera of both eyes, side by side in grey, which sends `count` pictures at a rate.
FakeVideo camera_with(int count, double rate) {
  FakeVideo video;
  FakeDevice camera;
  camera.path = "/dev/video0";
  camera.card = "ELP-STEREO";
  camera.modes = {{kGrey, 2 * kWidth, kHeight, {30, 15}}};
  camera.film(100.1, count, rate, kBoth);
  video.cameras = {camera};
  return video;
}

struct Run {
  std::vector<Frame> frames;
  std::vector<std::string> reports;
  SourceTroubles troubles;
};

// Reads for some seconds.
Run run(FakeVideo& video, const CameraRequest& wanted, double seconds) {
  const auto source = value_or_throw(open_camera(wanted, video));
  SourceGuard guard(*source);
  Run result;
  Frame frame;
  const double end = video.time + seconds;
  while (video.time < end) {
    if (guard.next(frame) == FrameStatus::kFrame) result.frames.push_back(frame);
    for (std::string& line : guard.take_reports()) result.reports.push_back(std::move(line));
  }
  result.troubles = guard.troubles();
  return result;
}

TEST_CASE("a stream for which USB has no bandwidth says so, and what to do",
          "[sources][camera][refusal]") {
  FakeVideo video = camera_with(3, 30);
  video.cameras[0].start_error = ENOSPC;
  const std::string text = test::camera_refusal(video, test::camera_request());
  CHECK_THAT(text, Contains("/dev/video0 does not start: USB has no bandwidth left for 64x10 GREY "
                            "at 30 pictures a second"));
  CHECK_THAT(text, Contains("--size") && Contains("--fps") && Contains("port"));
  CHECK_THAT(text, !Contains("No space left"));
  // The second of two cameras is the one that does not fit.
  FakeVideo two = camera_with(3, 30);
  two.cameras[0].modes = {{kGrey, kWidth, kHeight, {30}}};
  two.cameras.push_back(two.cameras[0]);
  two.cameras[1].path = "/dev/video2";
  two.cameras[1].start_error = ENOSPC;
  CameraRequest wanted = test::camera_request();
  wanted.right = "/dev/video2";
  CHECK_THAT(test::camera_refusal(two, wanted),
             Contains("/dev/video2 does not start: USB has no bandwidth"));
  // A camera that hangs is another matter.
  video.cameras[0].start_error = EPROTO;
  CHECK_THAT(test::camera_refusal(video, test::camera_request()),
             Contains("does not answer") && Contains("unplug it"));
}

TEST_CASE("a camera that another program holds names that program", "[sources][camera][refusal]") {
  FakeVideo video = camera_with(3, 30);
  FakeDevice& camera = video.cameras[0];
  camera.users = "cheese (process 4711)";
  CHECK(open_camera(test::camera_request(), video).ok());  // open elsewhere, but not streaming
  camera.format_error = EBUSY;                             // as uvcvideo has it
  CHECK_THAT(test::camera_refusal(video, test::camera_request()),
             Contains("another program is using it: close cheese (process 4711)"));
  camera.users.clear();  // of another user, whom this one cannot see
  CHECK_THAT(test::camera_refusal(video, test::camera_request()),
             Contains("another program is using it") && Contains("sudo fuser -v /dev/video0"));
  camera.format_error = 0;
  camera.start_error = EBUSY;
  CHECK_THAT(test::camera_refusal(video, test::camera_request()),
             Contains("does not start: another program is using it"));
}

TEST_CASE("a size that is missing on a USB 2 port is said to be so", "[sources][camera][refusal]") {
  FakeVideo video = camera_with(3, 30);
  FakeDevice& camera = video.cameras[0];
  CameraRequest wanted = test::camera_request();
  wanted.width = 2560;
  wanted.height = 720;
  const auto missing = [&](double megabits, double version) {
    camera.usb = {megabits, version};
    const std::string text = test::camera_refusal(video, wanted);
    CHECK_THAT(text, Contains("has no pictures of 2560x720 px; it has 64x10"));
    return text;
  };
  CHECK_THAT(missing(480, 2.1), Contains("plugged into a USB 2 port") && Contains("USB 3 port"));
  // A USB 3 port, a camera for USB 2, and no USB at all.
  CHECK_THAT(missing(5000, 3), !Contains("USB"));
  CHECK_THAT(missing(480, 2), !Contains("USB"));
  CHECK_THAT(missing(0, 0), !Contains("USB"));

  // No size was asked for: the run goes on at the size that there is, and a note says why.
  camera.usb = {480, 2.1};
  const std::vector<std::string> notes =
      value_or_throw(open_camera(test::camera_request(), video))->take_notes();
  REQUIRE(notes.size() == 1);
  CHECK_THAT(notes[0], Contains("/dev/video0 gives 64x10 px") && Contains("USB 2 port"));
  camera.usb = {5000, 3};
  CHECK(value_or_throw(open_camera(test::camera_request(), video))->take_notes().empty());
  // The calibration is of the larger size.
  camera.usb = {480, 2.1};
  wanted = test::camera_request();
  wanted.without_calibration = false;
  CHECK_THAT(test::camera_refusal(video, wanted),
             Contains("no calibration is known") && Contains("USB 2 port"));
  // A rate that the port does not offer.
  wanted = test::camera_request();
  wanted.frames_per_second = 60;
  const auto slow = value_or_throw(open_camera(wanted, video));
  CHECK_THAT(slow->take_notes().back(),
             Contains("offers 30 pictures a second of 64x10 px, not 60") && Contains("USB 2 port"));
}

TEST_CASE("pictures shorter than a picture are left out and counted, flagged or not",
          "[sources][camera]") {
  for (const std::uint32_t format : {kGrey, kYuyv, four_letters("Y8I "), four_letters("MJPG")}) {
    INFO(letters_of(format));
    FakeVideo video = camera_with(12, 30);
    FakeDevice& camera = video.cameras[0];
    const bool interleaved = format == four_letters("Y8I ");
    camera.modes = {{format, interleaved ? kWidth : 2 * kWidth, kHeight, {30}}};
    for (test::Shot& shot : camera.shots) {
      shot.bytes.resize(format == kYuyv ? 2 * kBoth : kBoth, 7);
    }
    if (format == four_letters("MJPG")) {
      for (test::Shot& shot : camera.shots) shot.bytes = {0xFF, 0xD8, 0xFF, 0xE0};
    } else {
      camera.shots[4].bytes.pop_back();
      camera.shots[7].bytes.clear();
    }
    const Run seen = run(video, test::camera_request(), 0.7);
    if (format == four_letters("MJPG")) {
      CHECK(seen.frames.empty());
      CHECK(seen.troubles.unreadable == 12);
      CHECK_THAT(seen.reports.front(), Contains("the picture is cut off"));
    } else {
      CHECK(seen.frames.size() == 10);
      CHECK(seen.troubles.unreadable == 2);
      CHECK_THAT(seen.reports.front(),
                 Contains("frame 4 is left out: the camera sent") && Contains(" bytes"));
    }
  }
}

TEST_CASE("a camera of which no picture can be used says what may help", "[sources][camera]") {
  FakeVideo video = camera_with(60, 30);
  for (test::Shot& shot : video.cameras[0].shots) shot.bytes.resize(kBoth / 2);
  const Run seen = run(video, test::camera_request(), 2.2);
  CHECK(seen.frames.empty());
  CHECK(seen.troubles.unreadable == 60);
  REQUIRE(seen.reports.size() >= 2);
  CHECK_THAT(seen.reports[0], Contains("frame 0 is left out"));
  CHECK_THAT(seen.reports[1], Contains("30 pictures in a row cannot be used") &&
                                  Contains("320 of 640 bytes") && Contains("--size"));
  int said = 0;
  for (const std::string& line : seen.reports) {
    said += static_cast<int>(line.find("in a row") != line.npos);
  }
  CHECK(said == 1);
}

TEST_CASE("first pictures with a stamp of another time do not reach the run", "[sources][camera]") {
  for (const double stamp : {40.0, 4154505010.2}) {  // an earlier stream; raspberrypi/linux#1984
    INFO(stamp);
    FakeVideo video = camera_with(20, 30);
    for (int i = 0; i < 2; ++i) video.cameras[0].shots[i].stamp = stamp + 0.5 * i;
    const Run seen = run(video, test::camera_request(), 0.9);
    REQUIRE(seen.frames.size() == 18);
    CHECK(seen.frames[0].number == 2);
    CHECK(seen.frames[0].time == 0);
    for (std::size_t i = 1; i < seen.frames.size(); ++i) {
      CHECK(seen.frames[i].time - seen.frames[i - 1].time == Approx(1 / 30.0).margin(2e-6));
    }
    CHECK(seen.troubles.unreadable == 2);
    CHECK_THAT(seen.reports.front(), Contains("frame 0 is left out: its time stamp is"));
  }
}

TEST_CASE("a stamp of another time does not keep two cameras from pairing", "[sources][camera]") {
  FakeVideo video = camera_with(30, 30);
  video.cameras[0].modes = {{kGrey, kWidth, kHeight, {30}}};
  video.cameras.push_back(video.cameras[0]);
  video.cameras[1].path = "/dev/video2";
  video.cameras[1].shots[0].stamp = 4154505010.2;
  CameraRequest wanted = test::camera_request();
  wanted.right = "/dev/video2";
  const Run seen = run(video, wanted, 1.0);
  CHECK(seen.frames.size() >= 24);
  CHECK(seen.troubles.stalls == 0);
}

TEST_CASE("stamps of another clock, or that stand still, give even times", "[sources][camera]") {
  for (const bool advances : {true, false}) {
    INFO(advances);
    FakeVideo video = camera_with(20, 30);
    FakeDevice& camera = video.cameras[0];
    camera.has_system_clock = false;
    for (test::Shot& shot : camera.shots) {
      shot.stamp = advances ? 1.7e9 + shot.time : 1.7e9;  // s since 1970; raspberrypi/linux#2351
    }
    const Run seen = run(video, test::camera_request(), 0.9);
    REQUIRE(seen.frames.size() == 20);
    for (std::size_t i = 1; i < seen.frames.size(); ++i) {
      CHECK(seen.frames[i].time - seen.frames[i - 1].time == Approx(1 / 30.0).margin(2e-6));
    }
    CHECK(seen.reports.empty());
  }
}

constexpr std::uint32_t kDynamic = V4L2_CID_EXPOSURE_AUTO_PRIORITY;

// The lines that are about the rate.
std::vector<std::string> about_rate(const Run& seen) {
  std::vector<std::string> lines;
  for (const std::string& line : seen.reports) {
    if (line.find("pictures a second") != line.npos) lines.push_back(line);
  }
  return lines;
}

TEST_CASE("an exposure that lowers the rate is kept from it", "[sources][camera]") {
  FakeVideo video = camera_with(30, 15);  // a dim room: 30 were set
  FakeDevice& camera = video.cameras[0];
  camera.controls = {{kDynamic, 1}, {V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_APERTURE_PRIORITY}};
  const auto source = value_or_throw(open_camera(test::camera_request(), video));
  SourceGuard guard(*source);
  Frame frame;
  std::vector<std::string> reports;
  const auto read_until = [&](double end) {
    while (video.time < end) {
      static_cast<void>(guard.next(frame));
      for (std::string& line : guard.take_reports()) reports.push_back(std::move(line));
    }
  };
  while (camera.controls[kDynamic] == 1 && video.time < 103) read_until(video.time + 0.05);
  CHECK(camera.controls[kDynamic] == 0);
  REQUIRE(reports.size() == 1);
  CHECK_THAT(reports[0], Contains("/dev/video0 takes 15 pictures a second, not 30") &&
                             Contains("exposure_dynamic_framerate was switched off"));
  // It has helped: nothing more is said.
  camera.shots.clear();
  camera.film(video.time + 0.1, 60, 30, kBoth);
  read_until(video.time + 2);
  CHECK(reports.size() == 1);
}

TEST_CASE("a low rate that cannot be helped is said once, with what may help",
          "[sources][camera]") {
  CameraRequest wanted = test::camera_request();
  // Switching off has not helped.
  FakeVideo video = camera_with(60, 15);
  video.cameras[0].controls = {{kDynamic, 1}};
  std::vector<std::string> lines = about_rate(run(video, wanted, 4));
  REQUIRE(lines.size() == 2);
  CHECK_THAT(lines[0], Contains("switched off"));
  CHECK_THAT(lines[1], Contains("15 pictures a second, not 30: more light, or --exposure 20") &&
                           Contains("--fps 15"));
  // No such control, or one that cannot be set.
  video = camera_with(60, 15);
  video.cameras[0].controls = {{kDynamic, 1}};
  video.cameras[0].read_only = {kDynamic};
  lines = about_rate(run(video, wanted, 4));
  REQUIRE(lines.size() == 1);
  CHECK_THAT(lines[0], Contains("15 pictures a second, not 30: it may expose longer in dim light"));
  video = camera_with(60, 15);
  CHECK(about_rate(run(video, wanted, 4)).size() == 1);
  // The user's own exposure.
  video = camera_with(60, 15);
  video.cameras[0].controls = {{V4L2_CID_EXPOSURE_ABSOLUTE, 100}};
  wanted.exposure_ms = 60;
  lines = about_rate(run(video, wanted, 4));
  REQUIRE(lines.size() == 1);
  CHECK_THAT(lines[0], Contains("--exposure 60 is longer than the 33.3 ms between pictures"));
}

TEST_CASE("a right rate changes nothing and says nothing", "[sources][camera]") {
  for (const double rate : {30.0, 25.0}) {  // 25: lamps that flicker at 50 Hz
    INFO(rate);
    FakeVideo video = camera_with(90, rate);
    video.cameras[0].controls = {{kDynamic, 1}};
    CHECK(about_rate(run(video, test::camera_request(), 3)).empty());
    CHECK(video.cameras[0].controls[kDynamic] == 1);
  }
  CameraRequest wanted = test::camera_request();
  wanted.frames_per_second = 15;
  FakeVideo asked = camera_with(60, 15);
  asked.cameras[0].controls = {{kDynamic, 1}};
  CHECK(about_rate(run(asked, wanted, 4)).empty());
  CHECK(asked.cameras[0].controls[kDynamic] == 1);
  // A reader that is too slow for the camera.
  FakeVideo video = camera_with(200, 30);
  video.cameras[0].controls = {{kDynamic, 1}};
  const auto source = value_or_throw(open_camera(test::camera_request(), video));
  Frame frame;
  while (video.time < 106) {
    static_cast<void>(source->next(frame));
    video.time += 0.12;
  }
  CHECK(source->take_notes().empty());
  CHECK(video.cameras[0].controls[kDynamic] == 1);
}

TEST_CASE("exposure is locked only after it was kept from lowering the rate", "[sources][camera]") {
  FakeVideo video = camera_with(60, 15);
  FakeDevice& camera = video.cameras[0];
  camera.controls = {{kDynamic, 1},
                     {V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_APERTURE_PRIORITY},
                     {V4L2_CID_EXPOSURE_ABSOLUTE, 640}};  // 64 ms
  CameraRequest wanted = test::camera_request();
  wanted.lock = true;
  const auto source = value_or_throw(open_camera(wanted, video));
  Frame frame;
  while (camera.controls[kDynamic] == 1 && video.time < 103) static_cast<void>(source->next(frame));
  CHECK(camera.controls[V4L2_CID_EXPOSURE_AUTO] == V4L2_EXPOSURE_APERTURE_PRIORITY);
  camera.controls[V4L2_CID_EXPOSURE_ABSOLUTE] = 330;  // by the automatic
  camera.shots.clear();
  camera.film(video.time + 0.1, 90, 30, kBoth);
  const double end = video.time + 2.5;
  while (video.time < end) static_cast<void>(source->next(frame));
  CHECK(camera.controls[V4L2_CID_EXPOSURE_AUTO] == V4L2_EXPOSURE_MANUAL);
  CHECK(camera.controls[V4L2_CID_EXPOSURE_ABSOLUTE] == 330);
}

}  // namespace
}  // namespace palpable

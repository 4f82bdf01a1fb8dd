#include "palpable/live/sources/camera_trial.h"

#include "palpable/live/sources/raw_picture.h"
#include "tests/support/fake_video.h"
#include "tests/support/test.h"

#include <cerrno>
#include <cstdint>
#include <string>
#include <vector>

namespace palpable {
namespace {

using Catch::Matchers::Contains;

// A camera with one mode, that sends pictures of `bytes` bytes at a rate.
test::FakeVideo camera_of(const test::FakeMode& mode, std::size_t bytes, double rate) {
  test::FakeVideo video;
  test::FakeDevice camera;
  camera.path = "/dev/video0";
  camera.modes = {mode};
  camera.film(100.2, 120, rate, bytes);
  video.cameras = {camera};
  return video;
}

CameraTrial trial_of(test::FakeVideo& video) {
  const std::vector<ListedCamera> cameras = list_cameras(video, {});
  REQUIRE(cameras.size() == 1);
  const CameraTrial trial = try_camera(video, cameras[0], 3);
  CHECK(video.opened == 0);
  return trial;
}

TEST_CASE("a camera of each kind that works is found to work", "[sources][camera]") {
  struct Kind {
    const char (&letters)[5];
    int width;
    int bytes;  // per pixel
  };
  for (const Kind& kind : {Kind{"GREY", 64, 1}, Kind{"GREY", 30, 1}, Kind{"Z16 ", 32, 2},
                           Kind{"Y16 ", 32, 2}, Kind{"Y8I ", 32, 2}, Kind{"YUYV", 64, 2}}) {
    INFO(kind.letters << kind.width);
    test::FakeVideo video = camera_of({four_letters(kind.letters), kind.width, 20, {30}},
                                      kind.bytes * kind.width * 20, 30);
    const CameraTrial trial = trial_of(video);
    CHECK(what_is_wrong_with(trial).empty());
    CHECK(trial.pictures >= 80);
    CHECK(trial.unusable == 0);
    CHECK((trial.width == kind.width && trial.height == 20));
    CHECK(letters_of(four_letters(kind.letters)) == trial.format);
  }
}

TEST_CASE("a trial says what keeps a camera from working", "[sources][camera]") {
  const test::FakeMode both{four_letters("GREY"), 64, 20, {30}};
  constexpr std::size_t kBytes = 64 * 20;
  test::FakeVideo video = camera_of(both, kBytes, 30);
  video.cameras[0].start_error = ENOSPC;
  CHECK_THAT(what_is_wrong_with(trial_of(video)), Contains("USB has no bandwidth left"));
  video = camera_of(both, kBytes, 30);
  video.cameras[0].format_error = EBUSY;
  video.cameras[0].users = "zoom (process 12)";
  CHECK_THAT(what_is_wrong_with(trial_of(video)), Contains("close zoom (process 12)"));
  video = camera_of(both, kBytes, 15);
  CHECK_THAT(what_is_wrong_with(trial_of(video)), Contains("takes 15 pictures a second, not 30"));
  video = camera_of(both, kBytes / 2, 30);
  CHECK_THAT(what_is_wrong_with(trial_of(video)),
             Contains("pictures cannot be used") && Contains("640 of 1280 bytes"));
  video = camera_of(both, kBytes, 30);
  video.cameras[0].shots.clear();
  CHECK_THAT(what_is_wrong_with(trial_of(video)), Contains("sent no picture in 3 s"));
  video = camera_of(both, kBytes, 30);
  video.cameras[0].gone_from = 101;
  CHECK_THAT(what_is_wrong_with(trial_of(video)), Contains("/dev/video0: No such device"));

  // The first pictures of many cameras are incomplete.
  video = camera_of(both, kBytes, 30);
  for (int i = 0; i < 3; ++i) video.cameras[0].shots[i].bytes.resize(9);
  CHECK(what_is_wrong_with(trial_of(video)).empty());
}

TEST_CASE("a trial leaves the camera's settings as they were", "[sources][camera]") {
  test::FakeVideo video = camera_of({four_letters("GREY"), 64, 20, {30}}, 64 * 20, 15);
  video.cameras[0].controls = {{V4L2_CID_EXPOSURE_AUTO_PRIORITY, 1}};
  CHECK_THAT(what_is_wrong_with(trial_of(video)), Contains("exposure_dynamic_framerate"));
  CHECK(video.cameras[0].controls[V4L2_CID_EXPOSURE_AUTO_PRIORITY] == 1);
}

}  // namespace
}  // namespace palpable

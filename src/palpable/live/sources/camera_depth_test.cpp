#include "palpable/live/sources/camera_source.h"
#include "tests/support/camera_request.h"
#include "tests/support/fake_video.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace palpable {
namespace {

using Catch::Matchers::Contains;
using test::FakeDevice;
using test::FakeVideo;
using test::ScratchFolder;

constexpr std::uint32_t kZ16 = four_letters("Z16 ");
constexpr std::uint32_t kY16 = four_letters("Y16 ");
constexpr int kWidth = 32;
constexpr int kHeight = 10;
constexpr std::size_t kPixels = kWidth * kHeight;

// A colour camera and a depth camera with the format `code`, whose pictures hold the number 5000.
FakeVideo color_and_depth(std::uint32_t code, const std::string& product) {
  FakeVideo video;
  FakeDevice color;
  color.path = "/dev/video0";
  color.modes = {{four_letters("GREY"), kWidth, kHeight, {30}}};
  color.film(100, 3, 30, kPixels, 50);
  FakeDevice depth = color;
  depth.path = "/dev/video1";
  depth.card = product.substr(0, 31);
  depth.product = product;
  depth.modes = {{code, kWidth, kHeight, {30}}};
  depth.shots.clear();
  std::vector<std::uint8_t> bytes;
  for (std::size_t k = 0; k < kPixels; ++k) {
    bytes.push_back(5000 & 0xFF);
    bytes.push_back(5000 >> 8);
  }
  for (int i = 0; i < 3; ++i) depth.shots.push_back({100.001 + i / 30.0, bytes});
  video.cameras = {color, depth};
  return video;
}

CameraRequest depth_request(const ScratchFolder& folder, const std::string& intrinsics) {
  CameraRequest wanted;
  wanted.device = "/dev/video0";
  wanted.depth = "/dev/video1";
  wanted.calibration = folder / "intrinsics.txt";
  test::write_bytes(wanted.calibration, intrinsics);
  return wanted;
}

TEST_CASE("the unit of Z16 is what was stated, that of the known device, or 1 mm and said so",
          "[sources][camera][depth_unit]") {
  const ScratchFolder folder("camera_depth_unit");
  struct Opened {
    float depth;
    bool assumed;
    std::string note;
  };
  const auto opened = [&](const std::string& product, std::optional<double> unit,
                          const std::string& intrinsics) -> Opened {
    FakeVideo video = color_and_depth(kZ16, product);
    CameraRequest wanted = depth_request(folder, intrinsics);
    wanted.depth_unit = unit;
    const auto source = value_or_throw(open_camera(wanted, video));
    Frame frame;
    CHECK(source->next(frame) == FrameStatus::kFrame);
    const std::vector<std::string> notes = source->take_notes();
    CHECK(source->take_notes().empty());
    return {frame.depth(3, 3), source->format().depth_unit_assumed,
            notes.empty() ? std::string() : notes.front()};
  };
  const std::string plain = "30 30 16 5 32 10";
  const Opened d405 = opened("Intel(R) RealSense(TM) Depth Camera 405", {}, plain);
  CHECK(d405.depth == Approx(0.5));
  CHECK_FALSE(d405.assumed);
  CHECK_THAT(d405.note, Contains("0.1 mm, as known of Intel(R) RealSense(TM) Depth Camera 405"));
  const Opened unknown = opened("Some Depth Camera", {}, plain);
  CHECK(unknown.depth == Approx(5));
  CHECK(unknown.assumed);
  CHECK_THAT(unknown.note, Contains("nothing states the unit"));
  const Opened asked = opened("Intel(R) RealSense(TM) Depth Camera 405", 2e-4, plain);
  CHECK(asked.depth == Approx(1));
  CHECK(asked.note.empty());
  const Opened in_file = opened("Some Depth Camera", {}, plain + "\nunit_m 0.0001");
  CHECK(in_file.depth == Approx(0.5));
  CHECK(in_file.note.empty());
  // The maker's name was cut off before its number, and the system has no other.
  FakeVideo cut = color_and_depth(kZ16, "Intel(R) RealSense(TM) Depth Camera 405");
  cut.cameras[1].product.clear();
  const auto source = value_or_throw(open_camera(depth_request(folder, plain), cut));
  CHECK(source->format().depth_unit_assumed);
  CHECK_THAT(source->take_notes().front(), Contains("a RealSense D405 has 0.1mm"));
}

TEST_CASE("Y16 is depth only where somebody says what its unit is",
          "[sources][camera][depth_unit]") {
  const ScratchFolder folder("camera_y16");
  const std::string plain = "30 30 16 5 32 10";
  FakeVideo video = color_and_depth(kY16, "Orbbec Astra");
  const std::string refused = test::camera_refusal(video, depth_request(folder, plain));
  CHECK_THAT(refused, Contains("/dev/video1 (Orbbec Astra) gives Y16"));
  CHECK_THAT(refused, Contains("--depth-unit"));
  CameraRequest wanted = depth_request(folder, plain);
  wanted.depth_unit = 1e-4;
  Frame frame;
  {
    const auto source = value_or_throw(open_camera(wanted, video));
    REQUIRE(source->next(frame) == FrameStatus::kFrame);
    CHECK(frame.depth(3, 3) == Approx(0.5));
  }
  FakeVideo other = color_and_depth(kY16, "Orbbec Astra");
  {
    const auto source =
        value_or_throw(open_camera(depth_request(folder, plain + " 0.0002"), other));
    REQUIRE(source->next(frame) == FrameStatus::kFrame);
    CHECK(frame.depth(3, 3) == Approx(1));
  }
  // A device with both: Z16 is its depth, also where Y16 is faster.
  FakeVideo both = color_and_depth(kZ16, "Depth");
  both.cameras[1].modes.push_back({kY16, kWidth, kHeight, {90}});
  const auto source = value_or_throw(open_camera(wanted, both));
  CHECK(both.cameras[1].modes.size() == 2);
  REQUIRE(source->next(frame) == FrameStatus::kFrame);
  CHECK(frame.depth(3, 3) == Approx(0.5));
  // A unit without a depth camera has no meaning.
  FakeVideo stereo = color_and_depth(kZ16, "Depth");
  CameraRequest no_depth;
  no_depth.device = "/dev/video0";
  no_depth.depth_unit = 1e-3;
  CHECK_THAT(test::camera_refusal(stereo, no_depth), Contains("--depth-source"));
}

}  // namespace
}  // namespace palpable

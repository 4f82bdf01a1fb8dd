#include "palpable/live/sources/source_calibration.h"

#include "palpable/live/calibrate/calibration_file.h"
#include "tests/support/replaced.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <string>

namespace palpable {
namespace {

using test::ScratchFolder;
using test::write_bytes;

// A ZED's factory file for eyes of 1920 x 1080 px.
const std::string kConf =
    "[LEFT_CAM_FHD]\nfx=1050\nfy=1051\ncx=960\ncy=540\nk1=-0.17\nk2=0.027\n"
    "[RIGHT_CAM_FHD]\nfx=1049\nfy=1050\ncx=961\ncy=541\nk1=-0.17\nk2=0.027\n"
    "[STEREO]\nBaseline=63.5\nCV_FHD=0.02\nRX_FHD=0\nRZ_FHD=0\n";

bool contains(const std::string& text, const std::string& part) {
  UNSCOPED_INFO(text);
  return text.find(part) != std::string::npos;
}

TEST_CASE("one reader tells every kind of calibration apart", "[sources][calibration]") {
  const ScratchFolder folder("source_calibration");
  write_bytes(folder / "SN1.conf", kConf);
  const auto factory = value_or_throw(read_source_calibration(folder / "SN1.conf", 1920, 1080));
  CHECK(factory.format.width == 1920);
  CHECK(factory.format.kind == FrameFormat::Kind::kStereo);

  StereoCalibration raw;
  raw.rig = factory.format.rig;
  raw.frames_per_second = 15;
  write_stereo_calibration(folder / "a.yml", raw);
  const auto yaml = value_or_throw(read_source_calibration(folder / "a.yml", 0, 0));
  CHECK(yaml.format.rig.left == raw.rig.left);
  CHECK(yaml.frames_per_second == 15);

  write_rectified_calibration(folder / "b.yml", {{{640, 480, 500, 500, 320, 240}, 0.1, 0}, 30});
  CHECK(value_or_throw(read_source_calibration(folder / "b.yml", 0, 0)).format.already_rectified);

  write_bytes(folder / "c.txt", "585 0 320\n0 586 240 # as 7-Scenes has it\n0 0 1\n");
  const auto depth = value_or_throw(read_source_calibration(folder / "c.txt", 0, 0));
  CHECK(depth.format.kind == FrameFormat::Kind::kColorDepth);
  CHECK(depth.format.depth_camera == PinholeCamera{0, 0, 585, 586, 320, 240});
  CHECK_FALSE(depth.format.color_sensor);

  const auto beside = [&](const std::string& color) {
    write_bytes(folder / "d.txt", "475 476 320 240 640 480 0.001\n" + color);
    return read_source_calibration(folder / "d.txt", 0, 0);
  };
  const FrameFormat same_place = value_or_throw(beside("color 600 601 322 243 # px\n")).format;
  CHECK(same_place.color_sensor->camera == PinholeCamera{640, 480, 600, 601, 322, 243});
  CHECK(same_place.color_sensor->color_from_depth.matrix().isIdentity(0));
  CHECK(same_place.depth_camera.fx_px == 475);
  const FrameFormat apart =
      value_or_throw(beside("color 600 601 322 243  1 0 0 -0.025  0 0 -1 0.002  0 1 0 0\n")).format;
  CHECK(apart.color_sensor->color_from_depth * Eigen::Vector3d(0, 0, 1) ==
        Eigen::Vector3d(-0.025, -0.998, 0));
  const auto refusal = [&](const char* color) { return beside(color).problem().message; };
  CHECK(contains(refusal("color 600 601 322\n"), "fx fy cx cy"));
  CHECK(contains(refusal("color 600 -1 322 243\n"), "positive"));
  CHECK(contains(refusal("color 6 6 3 2  2 0 0 0  0 1 0 0  0 0 1 0\n"), "no rotation"));
  CHECK(contains(refusal("color 6 6 3 2  1 0 0 0  0 1 0 0  0 0 -1 0\n"), "no rotation"));
  CHECK(contains(refusal("color 6 6 3 2  1 0 0 -25  0 1 0 0  0 0 1 0\n"), "25 m apart"));

  const auto none = read_source_calibration(folder / "none.yml", 0, 0);
  REQUIRE_FALSE(none.ok());
  CHECK(contains(none.problem().message, "does not exist"));
}

TEST_CASE("a rig that cannot be rectified is refused with its file and what to do",
          "[sources][calibration]") {
  const ScratchFolder folder("source_calibration");
  std::string conf = kConf;
  for (const auto& [good, bad] : {std::pair{"fx=1050", "fx=500"},
                                  {"fy=1051", "fy=500"},
                                  {"k1=-0.17", "k1=0"},
                                  {"k2=0.027", "k2=0.2"}}) {
    conf = test::replaced(conf, good, bad);
  }
  write_bytes(folder / "SN1.conf", conf);
  const auto refused = read_source_calibration(folder / "SN1.conf", 1920, 1080);
  REQUIRE_FALSE(refused.ok());
  CHECK(contains(refused.problem().message, "SN1.conf cannot be used: rectified, the pictures"));
  CHECK(contains(refused.problem().message, "calibrate again"));
}

}  // namespace
}  // namespace palpable

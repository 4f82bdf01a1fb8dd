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
  CHECK(contains(refusal("color 600 -1 322 243\n"), "the colour focal length is -1 px"));
  const std::string lens = "color 600 600 322 243 ";
  const auto apart_by = [&](const char* pose) { return refusal((lens + pose).c_str()); };
  CHECK(contains(apart_by("2 0 0 0  0 1 0 0  0 0 1 0\n"), "no rotation"));
  CHECK(contains(apart_by("1 0 0 0  0 1 0 0  0 0 -1 0\n"), "no rotation"));
  CHECK(contains(apart_by("1 0 0 -25  0 1 0 0  0 0 1 0\n"), "25 m apart"));

  const auto unit_in = [&](const std::string& text) {
    write_bytes(folder / "e.txt", text);
    return value_or_throw(read_source_calibration(folder / "e.txt", 0, 0)).depth_unit;
  };
  CHECK_FALSE(unit_in("585 585 320 240\n"));
  CHECK_FALSE(unit_in("585 585 320 240 640 480\n"));
  CHECK(unit_in("585 585 320 240 640 480 0.0002\n") == 0.0002);
  CHECK(unit_in("585 585 320 240\nunit_m 0.0001 # D405\n") == 0.0001);
  CHECK(unit_in("unit_m 0.00025\n585 0 320 0 586 240 0 0 1\n") == 0.00025);
  const auto unit_refusal = [&](const std::string& text) {
    write_bytes(folder / "e.txt", text);
    return read_source_calibration(folder / "e.txt", 0, 0).problem().message;
  };
  CHECK(contains(unit_refusal("585 585 320 240\nunit_m 5000\n"), "5000 steps in a metre"));
  CHECK(contains(unit_refusal("585 585 320 240\nunit_m one\n"), "after 'unit_m'"));
  CHECK(contains(unit_refusal("5 5 3 2 6 4 0.001\nunit_m 0.002\n"), "twice"));

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

// The message about a file of this content; empty if it can be used.
std::string fault_of(const ScratchFolder& folder, const std::string& name,
                     const std::string& text) {
  write_bytes(folder / name, text);
  const auto read = read_source_calibration(folder / name, 0, 0);
  if (!read.ok()) return read.problem().message;
  const auto problem = problem_with(read.value(), BaselineRule::kUsual);
  return problem ? problem->message : "";
}

std::string rig_text(const std::string& T, const std::string& cx = "320") {
  const std::string lens =
      "D: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n   data: [ 0., 0., "
      "0., 0., 0. ]\n";
  const auto matrix = [](const std::string& name, const char* size, const std::string& data) {
    return name + ": !!opencv-matrix\n   rows: 3\n   cols: " + size + "\n   dt: d\n   data: [ " +
           data + " ]\n";
  };
  const std::string K = "500., 0., " + cx + ", 0., 501., 240., 0., 0., 1.";
  return "%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\n" + matrix("K1", "3", K) +
         test::replaced(lens, "D:", "D1:") + matrix("K2", "3", K) +
         test::replaced(lens, "D:", "D2:") +
         matrix("R", "3", "1., 0., 0., 0., 1., 0., 0., 0., 1.") + matrix("T", "1", T);
}

std::string rectified_text(const std::string& baseline, const std::string& cx = "320.0",
                           const std::string& fx = "500.0") {
  return "%YAML:1.0\n---\nfx: " + fx + "\nfy: 500.0\ncx: " + cx +
         "\ncy: 240.0\nwidth: 640\nheight: 480\nbaseline_m: " + baseline + "\n";
}

std::string conf_text(const std::string& baseline, const std::string& cx = "960") {
  std::string text = kConf;
  if (baseline != "63.5") text = test::replaced(text, "=63.5", "=" + baseline);
  return cx == "960" ? text : test::replaced(text, "cx=960", "cx=" + cx);
}

TEST_CASE(
    "a baseline in another unit is refused in every kind of file, with squares and units named",
    "[sources][calibration][refusal]") {
  const ScratchFolder folder("baseline_units");
  const auto unusual = [&](const std::string& name, const std::string& text) {
    const std::string fault = fault_of(folder, name, text);
    for (const char* part : {name.c_str(), "squares of a board", "metre", "--baseline-ok"}) {
      CHECK(contains(fault, part));
    }
    // With the user's word it is taken.
    const auto read = value_or_throw(read_source_calibration(folder / name, 0, 0));
    CHECK_FALSE(problem_with(read, BaselineRule::kAnyPossible));
  };
  unusual("rig.yml", rig_text("-2.52, 0., 0."));
  unusual("rig.yml", rig_text("-6., 0., 0."));
  unusual("rig.yml", rig_text("-0.0025, 0., 0."));
  unusual("rectified.yml", rectified_text("2.52"));
  unusual("rectified.yml", rectified_text("6.3"));
  unusual("rectified.yml", rectified_text("0.0025"));
  unusual("SN1.conf", conf_text("6300"));
  unusual("SN1.conf", conf_text("2.52"));
  CHECK(contains(fault_of(folder, "rig.yml", rig_text("-2.52, 0., 0.")),
                 "2.52 squares of 25 mm are 63.0 mm"));
  // Beyond 10 m nothing helps but the unit.
  CHECK(contains(fault_of(folder, "rig.yml", rig_text("-63., 0., 0.")), "millimetres"));
}

TEST_CASE("baselines from 10 mm to 1 m are taken as they are", "[sources][calibration]") {
  const ScratchFolder folder("usual_baselines");
  for (const char* baseline : {"0.01", "0.025", "0.063", "0.12", "0.193001", "0.5371506", "1.0"}) {
    INFO(baseline);
    CHECK(fault_of(folder, "rig.yml", rig_text(std::string("-") + baseline + ", 0., 0.")) == "");
    CHECK(fault_of(folder, "rectified.yml", rectified_text(baseline)) == "");
  }
  for (const char* mm : {"63.5", "-63.5", "119.9", "540"}) {
    CHECK(fault_of(folder, "SN1.conf", conf_text(mm)) == "");
  }
}

TEST_CASE(
    "principal points outside the picture and focal lengths of no picture are refused in "
    "every kind of file",
    "[sources][calibration][refusal]") {
  const ScratchFolder folder("principal_points");
  for (const char* cx : {"650.", "-325.", "640."}) {
    INFO(cx);
    const std::string numbers = std::string("500 500 ") + cx + " 240 640 480";
    CHECK(contains(fault_of(folder, "rig.yml", rig_text("-0.063, 0., 0.", cx)), "principal point"));
    CHECK(contains(fault_of(folder, "rectified.yml", rectified_text("0.063", cx)),
                   "principal point"));
    CHECK(contains(fault_of(folder, "intrinsics.txt", numbers), "principal point"));
    CHECK(contains(
        fault_of(folder, "intrinsics.txt",
                 "500 500 320 240 640 480\ncolor " + numbers.substr(0, numbers.size() - 8)),
        "the colour principal point"));
  }
  CHECK(contains(fault_of(folder, "SN1.conf", conf_text("63.5", "-960")), "principal point"));
  CHECK(contains(fault_of(folder, "SN1.conf", conf_text("63.5", "1921")), "principal point"));
  CHECK(contains(fault_of(folder, "rectified.yml", rectified_text("0.063", "320.0", "0.35")),
                 "share of the picture's width"));
  CHECK(contains(fault_of(folder, "intrinsics.txt", "0.35 0.35 320 240 640 480"), "0.35 px"));
  CHECK(contains(fault_of(folder, "intrinsics.txt", "4.2 4.2 320 240 640 480"), "millimetres"));
  // A crop may have its principal point near a border.
  for (const char* cx : {"2.", "12.5", "630.", "639."}) {
    CHECK(fault_of(folder, "rig.yml", rig_text("-0.063, 0., 0.", cx)) == "");
    CHECK(fault_of(folder, "intrinsics.txt", std::string("500 500 ") + cx + " 240 640 480") == "");
  }
}

TEST_CASE("swapped eyes are called so, and one eye given twice",
          "[sources][calibration][refusal]") {
  const ScratchFolder folder("swapped_eyes");
  CHECK(contains(fault_of(folder, "rig.yml", rig_text("0.063, 0., 0.")), "the eyes are swapped"));
  CHECK(contains(fault_of(folder, "rectified.yml", rectified_text("-0.063")),
                 "the eyes are swapped"));
  CHECK(contains(fault_of(folder, "rectified.yml", rectified_text("0.0")), "in one place"));
  CHECK(contains(fault_of(folder, "rig.yml", rig_text("0., 0., 0.")), "in one place"));
}

}  // namespace
}  // namespace palpable

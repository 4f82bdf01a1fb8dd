// 7-Scenes: https://www.microsoft.com/en-us/research/project/rgb-d-dataset-7-scenes
#include "palpable/common/base/text_numbers.h"
#include "palpable/live/sources/layouts.h"

#include <fmt/format.h>

namespace palpable {
namespace layouts {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSevenScenes = "7-Scenes";
const PinholeCamera kSevenScenesDepth{640, 480, 585, 585, 320, 240};

// The data set does not give the pose of its Kinect's two sensors. The focal length, rotation and
// translation here are those used by relocalisation papers (setup_7scenes.py of
// github.com/tsattler/visloc_pseudo_gt_limitations, Brachmann et al., ICCV 2021), measured with
// another Kinect: projet.liris.cnrs.fr/voir/activities-dataset/kinect-calibration.html.
ColorSensor seven_scenes_color() {
  ColorSensor color{{0, 0, 525, 525, 320, 240}, Rigid3::Identity()};
  color.color_from_depth.linear() << 9.9996518012567637e-01, 2.6765126468950343e-03,
      -7.9041012313000904e-03, -2.7409311281316700e-03, 9.9996302803027592e-01,
      -8.1504520778013286e-03, 7.8819942130445332e-03, 8.1718328771890631e-03,
      9.9993554558014031e-01;
  color.color_from_depth.translation() << -2.5558943178152542e-02, 1.0109636268061706e-04,
      2.0318321729487039e-03;
  return color;
}

}  // namespace

Recognised seven_scenes(const fs::path& folder) {
  const std::vector<fs::path> depth = images_in(folder, "frame-*.depth.*");
  if (depth.empty()) return std::nullopt;
  Result<Recording> pairs =
      pair_up(folder, kSevenScenes, ImagePair::kColorDepth,
              {images_in(folder, "frame-*.color.*"), "colour"}, {depth, "depth"});
  if (!pairs.ok()) return pairs;
  Recording& recording = pairs.value();
  recording.depth_unit = 1e-3;
  for (RecordedFrame& frame : recording.frames) {
    std::string name = frame.first.filename().string();
    name = name.substr(0, name.find(".color"));
    const fs::path pose = folder / (name + ".pose.txt");
    const std::string text = fmt::format("{}", fmt::join(lines_in(pose), "\n"));
    if (has_decimal_commas(text)) {
      return Problem{fmt::format("{} {}", pose.string(), kDecimalCommas)};
    }
    frame.world_from_camera = pose_of(to_numbers(text).value_or(std::vector<double>{}));
  }
  if (!is_there(folder / "camera-intrinsics.txt") && !is_there(folder / "intrinsics.txt")) {
    SourceCalibration& calibration = recording.calibration.emplace();
    calibration.file = "of 7-Scenes as published";
    calibration.format.kind = FrameFormat::Kind::kColorDepth;
    calibration.format.depth_camera = kSevenScenesDepth;
    calibration.format.color_sensor = seven_scenes_color();
    set_size(calibration.format, kSevenScenesDepth.width, kSevenScenesDepth.height);
    calibration.guesses.push_back(fmt::format(
        "{} has no intrinsics.txt: those of 7-Scenes are assumed (depth f = 585 px, colour f = 525 "
        "px, 640 x 480)",
        folder.string()));
  }
  return pairs;
}

}  // namespace layouts

void add_color_sensor(const Recording& recording, SourceCalibration& calibration) {
  FrameFormat& format = calibration.format;
  PinholeCamera published = layouts::kSevenScenesDepth;
  published.width = published.height = 0;  // as in a file that has only the published numbers
  if (recording.layout != layouts::kSevenScenes || format.color_sensor ||
      !(format.depth_camera == published)) {
    return;
  }
  format.color_sensor = layouts::seven_scenes_color();
  calibration.guesses.push_back(fmt::format(
      "{} has the numbers of 7-Scenes: its colour camera is assumed, too (f = 525 px, 26 mm beside "
      "the depth's); a line `color fx fy cx cy` states another, `fx fy cx cy width height` one "
      "view",
      calibration.file));
}

}  // namespace palpable

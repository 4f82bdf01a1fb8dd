// TUM: https://cvg.cit.tum.de/data/datasets/rgbd-dataset
#include "palpable/common/base/text_numbers.h"
#include "palpable/live/sources/layouts.h"

#include <array>
#include <cmath>
#include <system_error>

namespace palpable::layouts {
namespace {

namespace fs = std::filesystem;

// Reads lines like "1305031102.1758 rgb/1305031102.1758.png", sorted by stamp. Lines without a
// stamp, or with the stamp of an earlier line, are skipped and counted.
std::map<double, fs::path> stamped_files(const fs::path& folder, const char* list, int& left_out) {
  std::map<double, fs::path> files;
  for (const std::string& line : lines_in(folder / list)) {
    if (line.empty() || line.front() == '#') continue;
    const auto space = line.find(' ');
    const auto name = space == std::string::npos ? space : line.find_first_not_of(' ', space);
    const auto time = to_number(std::string_view(line).substr(0, space));
    if (name == std::string::npos || !time || !std::isfinite(*time) ||
        !files.emplace(*time, folder / line.substr(name)).second) {
      ++left_out;
    }
  }
  return files;
}

}  // namespace

Recognised tum(const fs::path& folder) {
  if (!is_there(folder / "rgb.txt") || !is_there(folder / "depth.txt")) return std::nullopt;
  Recording recording;
  recording.layout = "TUM";
  recording.pair = ImagePair::kColorDepth;
  recording.depth_unit = 1 / 5000.0;
  std::map<double, Rigid3> poses;
  for (const std::string& line : lines_in(folder / "groundtruth.txt")) {
    const auto n = to_numbers(line);
    if (!n || n->size() != 8) continue;
    poses[(*n)[0]] =
        pose_of(Eigen::Vector3d((*n)[1], (*n)[2], (*n)[3]), (*n)[7], (*n)[4], (*n)[5], (*n)[6]);
  }
  const std::map<double, fs::path> depths = stamped_files(folder, "depth.txt", recording.unmatched);
  for (const auto& [time, color] : stamped_files(folder, "rgb.txt", recording.unmatched)) {
    const fs::path* depth = nearest(depths, time);
    if (depth == nullptr) {
      ++recording.unmatched;
      continue;
    }
    RecordedFrame& frame = recording.frames.emplace_back();
    frame.first = color;
    frame.second = *depth;
    frame.time = time;
    if (const Rigid3* pose = nearest(poses, time)) frame.world_from_camera = *pose;
  }
  struct Published {
    const char* name;
    double fx, fy, cx, cy;  // px
  };
  constexpr std::array kPublished{Published{"freiburg1", 517.3, 516.5, 318.6, 255.3},
                                  Published{"freiburg2", 520.9, 521.0, 325.1, 249.7},
                                  Published{"freiburg3", 535.4, 539.2, 320.1, 247.6}};
  std::error_code ignored;
  const std::string name = fs::absolute(folder, ignored).lexically_normal().string();
  for (const Published& p : kPublished) {
    if (name.find(p.name) == std::string::npos || is_there(folder / "intrinsics.txt")) continue;
    SourceCalibration& calibration = recording.calibration.emplace();
    calibration.format.kind = FrameFormat::Kind::kColorDepth;
    calibration.format.depth_camera = {0, 0, p.fx, p.fy, p.cx, p.cy};
  }
  return recording;
}

}  // namespace palpable::layouts

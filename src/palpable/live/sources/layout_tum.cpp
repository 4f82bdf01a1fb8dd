// TUM: https://cvg.cit.tum.de/data/datasets/rgbd-dataset
// Bonn, which has its layout: https://www.ipb.uni-bonn.de/data/rgbd-dynamic-dataset
#include "palpable/common/base/text_numbers.h"
#include "palpable/common/base/time_stamps.h"
#include "palpable/live/sources/layouts.h"

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace palpable::layouts {
namespace {

namespace fs = std::filesystem;

// Reads lines like "1305031102.1758 rgb/1305031102.1758.png", sorted by stamp. Lines without a
// stamp, or with the stamp of an earlier line, are skipped and counted.
std::map<double, fs::path> stamped_files(const fs::path& folder, const char* list, int& left_out) {
  std::map<double, fs::path> files;
  for (const std::string& line : lines_in(folder / list)) {
    if (line.empty() || line.front() == '#') continue;
    const auto space = line.find_first_of(" \t");
    const auto name = space == std::string::npos ? space : line.find_first_not_of(" \t", space);
    const auto time = to_number(std::string_view(line).substr(0, space));
    if (name == std::string::npos || !time || !std::isfinite(*time) ||
        !files.emplace(*time, folder / line.substr(name)).second) {
      ++left_out;
    }
  }
  return files;
}

// Describes times that are not seconds; empty if there are none.
std::string wrong_stamps(const fs::path& folder, const char* color_list, const char* depth_list) {
  for (const char* list : {color_list, depth_list, "groundtruth.txt"}) {
    std::vector<double> times;
    for (const std::string& line : lines_in(folder / list)) {
      const std::string stamp = line.substr(0, line.find_first_of(" \t"));
      // One number alone is not judged: twice it is a line of two.
      if (has_decimal_commas(stamp + " " + stamp)) {
        return fmt::format("{}: '{}' {}", (folder / list).string(), line.substr(0, 40),
                           kDecimalCommas);
      }
      const auto time = to_number(std::string_view(line).substr(0, line.find_first_of(" \t,")));
      if (time) times.push_back(*time);
    }
    const std::string wrong = what_is_wrong_with_times(times);
    if (!wrong.empty()) return fmt::format("{}: {}", (folder / list).string(), wrong);
  }
  return {};
}

struct StampedFile {
  double time;  // s
  fs::path file;
};

// For each colour image the depth image of the same moment; null for one that has none, or whose
// depth image is nearer to another colour image: a depth belongs to one frame.
std::vector<const StampedFile*> depth_of_each(const std::map<double, fs::path>& colors,
                                              const std::map<double, StampedFile>& depths) {
  std::map<double, double> color_of;  // stamps, of a depth image to its nearest colour image
  for (const auto& [time, color] : colors) {
    const StampedFile* depth = nearest(depths, time);
    if (depth == nullptr) continue;
    const auto [entry, is_first] = color_of.emplace(depth->time, time);
    const double before = std::abs(entry->second - depth->time);
    if (!is_first && std::abs(time - depth->time) < before) entry->second = time;
  }
  std::vector<const StampedFile*> partners;
  for (const auto& [time, color] : colors) {
    const StampedFile* depth = nearest(depths, time);
    const bool is_its = depth != nullptr && color_of.at(depth->time) == time;
    partners.push_back(is_its ? depth : nullptr);
  }
  return partners;
}

// The published numbers of the data set that the path names; empty if it names none. The innermost
// name counts: freiburg1/rgbd_dataset_freiburg2_desk is of freiburg2.
std::optional<SourceCalibration> published_calibration(const fs::path& folder) {
  struct Published {
    const char* set;
    const char* name;
    double fx, fy, cx, cy;  // px
  };
  constexpr std::array kPublished{
      Published{"TUM", "freiburg1", 517.3, 516.5, 318.6, 255.3},
      Published{"TUM", "freiburg2", 520.9, 521.0, 325.1, 249.7},
      Published{"TUM", "freiburg3", 535.4, 539.2, 320.1, 247.6},
      Published{"Bonn", "rgbd_bonn", 542.822841, 542.576870, 315.593520, 237.756098}};
  std::error_code ignored;
  const std::string path = fs::absolute(folder, ignored).lexically_normal().string();
  const Published* named = nullptr;
  std::size_t last = 0;
  for (const Published& p : kPublished) {
    const std::size_t at = path.rfind(p.name);
    if (at == std::string::npos || (named != nullptr && at < last)) continue;
    named = &p;
    last = at;
  }
  if (named == nullptr) return std::nullopt;
  SourceCalibration calibration;
  calibration.file = fmt::format("of {}'s {} as published", named->set, named->name);
  calibration.format.kind = FrameFormat::Kind::kColorDepth;
  calibration.format.depth_camera = {0, 0, named->fx, named->fy, named->cx, named->cy};
  set_size(calibration.format, 640, 480);
  calibration.guesses.push_back(
      fmt::format("{} has no intrinsics.txt: those of {} are assumed from its name (f = {} px, 640 "
                  "x 480)",
                  folder.string(), named->name, named->fx));
  return calibration;
}

}  // namespace

Result<Recording> stamped_pairs(const fs::path& folder, std::string layout, const char* color_list,
                                const char* depth_list) {
  const std::string wrong = wrong_stamps(folder, color_list, depth_list);
  if (!wrong.empty()) return Problem{wrong};
  Recording recording;
  recording.layout = std::move(layout);
  recording.pair = ImagePair::kColorDepth;
  std::map<double, Rigid3> poses;
  for (const std::string& line : lines_in(folder / "groundtruth.txt")) {
    const auto n = to_numbers(line);
    if (!n || n->size() != 8) continue;
    poses[(*n)[0]] =
        pose_of(Eigen::Vector3d((*n)[1], (*n)[2], (*n)[3]), (*n)[7], (*n)[4], (*n)[5], (*n)[6]);
  }
  std::map<double, StampedFile> depths;
  for (const auto& [time, file] : stamped_files(folder, depth_list, recording.unmatched)) {
    depths[time] = {time, file};
  }
  const std::map<double, fs::path> colors = stamped_files(folder, color_list, recording.unmatched);
  std::size_t number = 0;
  const std::vector<const StampedFile*> partners = depth_of_each(colors, depths);
  for (const auto& [time, color] : colors) {
    const StampedFile* depth = partners[number++];
    if (depth == nullptr) {
      ++recording.unmatched;
      continue;
    }
    RecordedFrame& frame = recording.frames.emplace_back();
    frame.first = color;
    frame.second = depth->file;
    frame.time = time;
    if (const Rigid3* pose = nearest(poses, time)) frame.world_from_camera = *pose;
  }
  return recording;
}

Recognised tum(const fs::path& folder) {
  if (!is_there(folder / "rgb.txt") || !is_there(folder / "depth.txt")) return std::nullopt;
  Result<Recording> pairs = stamped_pairs(folder, "TUM", "rgb.txt", "depth.txt");
  if (!pairs.ok()) return pairs;
  Recording& recording = pairs.value();
  recording.depth_unit = 1 / 5000.0;
  const bool states =
      is_there(folder / "intrinsics.txt") || is_there(folder / "camera-intrinsics.txt");
  if (!states) recording.calibration = published_calibration(folder);
  return pairs;
}

}  // namespace palpable::layouts

// Stray Scanner, an app for iPhones with a depth sensor: https://github.com/strayrobots/scanner
#include "palpable/common/base/text_numbers.h"
#include "palpable/live/sources/layouts.h"

#include <fmt/core.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace palpable::layouts {
namespace {

namespace fs = std::filesystem;

struct StrayOdometry {
  std::map<long long, double> times;  // s
  std::map<long long, Rigid3> poses;  // world_from_camera
  std::vector<FrameLens> lenses;
};

// Lines `timestamp, frame, x, y, z, qx, qy, qz, qw`, in newer versions followed by `fx, fy, cx,
// cy`; in the oldest one only `x, y, z, qx, qy, qz, qw`. The app has turned ARKit's axes already: X
// right, Y down, Z forward.
StrayOdometry read_odometry(const fs::path& path) {
  StrayOdometry odometry;
  long long line_number = 0;
  for (const std::string& line : lines_in(path)) {
    const auto read = to_numbers(line);
    if (!read) continue;  // the names of the columns
    const std::vector<double>& n = *read;
    constexpr std::size_t kPose = 7, kStampedPose = 9, kPoseAndLens = 13;
    if (n.size() != kPose && n.size() < kStampedPose) continue;
    const std::size_t from = n.size() == kPose ? 0 : 2;
    const bool has_frame = from > 0 && n[1] >= 0 && n[1] < 1e9;
    const long long frame = has_frame ? static_cast<long long>(n[1]) : line_number;
    ++line_number;
    if (from > 0) odometry.times[frame] = n[0];
    odometry.poses[frame] = pose_of(Eigen::Vector3d(n[from], n[from + 1], n[from + 2]), n[from + 6],
                                    n[from + 3], n[from + 4], n[from + 5]);
    if (n.size() >= kPoseAndLens) odometry.lenses.push_back({n[9], n[10], n[11], n[12]});
  }
  return odometry;
}

// The lens of the colour pictures: that of the frames, else that of camera_matrix.csv, which is the
// last frame's.
Result<SourceCalibration> stray_calibration(const fs::path& folder, const StrayOdometry& odometry,
                                            std::vector<std::string>& notes) {
  if (!odometry.lenses.empty()) {
    const std::string file = (folder / "odometry.csv").string();
    return lens_calibration(median_lens(odometry.lenses, file, notes), file);
  }
  const fs::path path = folder / "camera_matrix.csv";
  std::string text;
  for (const std::string& line : lines_in(path)) text += line + "\n";
  const std::vector<double> n = to_numbers(text).value_or(std::vector<double>{});
  if (n.size() != 9 || n[1] != 0 || n[3] != 0 || !(n[0] > 0) || !(n[4] > 0)) {
    return Problem{fmt::format(
        "{} should hold the nine numbers fx 0 cx 0 fy cy 0 0 1 of the colour camera, px",
        path.string())};
  }
  return lens_calibration({n[0], n[4], n[2], n[5]}, path.string());
}

// Where the colour pictures are: a film, or pictures that somebody took out of it.
struct StrayColors {
  fs::path film;
  std::map<long long, fs::path> pictures;
};

StrayColors colors_in(const fs::path& folder) {
  StrayColors colors;
  for (const char* name : {"rgb.mp4", "rgb.mov", "rgb.MP4", "rgb.MOV"}) {
    if (colors.film.empty() && is_there(folder / name)) colors.film = folder / name;
  }
  for (const char* ending : {".jpg", ".png", ".jpeg"}) {
    if (colors.pictures.empty()) colors.pictures = numbered_files(folder / "rgb", ending);
  }
  return colors;
}

}  // namespace

Recognised stray(const fs::path& folder) {
  const bool has_matrix = is_there(folder / "camera_matrix.csv");
  if (!is_there(folder / "odometry.csv") && !has_matrix) return std::nullopt;
  if (!is_folder(folder / "depth")) return std::nullopt;
  const StrayColors colors = colors_in(folder);
  if (colors.film.empty() && colors.pictures.empty()) {
    return Problem{fmt::format("{} is laid out as Stray Scanner's folders are but has no rgb.mp4",
                               folder.string())};
  }
  const std::map<long long, fs::path> depths = numbered_files(folder / "depth", ".png");
  if (depths.empty()) {
    const bool has_arrays = !numbered_files(folder / "depth", ".npy").empty();
    return Problem{fmt::format(
        "{} has no depth/000000.png{}", folder.string(),
        has_arrays ? ": its .npy files are of an old Stray Scanner; write each of them as a 16-bit "
                     "PNG of the same number, mm"
                   : ", ... of 16 bits, mm")};
  }
  Recording recording;
  recording.layout = "Stray Scanner";
  recording.pair = ImagePair::kColorDepth;
  recording.depth_unit = 1e-3;
  recording.calibrates_color = true;
  recording.is_film = colors.pictures.empty();
  const StrayOdometry odometry = read_odometry(folder / "odometry.csv");
  Result<SourceCalibration> calibration = stray_calibration(folder, odometry, recording.notes);
  if (!calibration.ok()) return calibration.problem();
  recording.calibration = std::move(calibration).value();
  for (const auto& [number, depth] : depths) {
    constexpr long long kMostFrames = 100'000'000;
    const auto picture = colors.pictures.find(number);
    const bool has_picture = recording.is_film || picture != colors.pictures.end();
    const auto time = odometry.times.find(number);
    const bool has_time = odometry.times.empty() || time != odometry.times.end();
    if (!has_picture || !has_time || number > kMostFrames) {
      ++recording.unmatched;
      continue;
    }
    RecordedFrame& frame = recording.frames.emplace_back();
    frame.first = recording.is_film ? colors.film : picture->second;
    frame.second = depth;
    frame.in_film = static_cast<int>(number);
    if (!odometry.times.empty()) frame.time = time->second;
    if (const auto pose = odometry.poses.find(number); pose != odometry.poses.end()) {
      frame.world_from_camera = pose->second;
    }
    const fs::path confidence = folder / "confidence" / depth.filename();
    if (is_there(confidence)) frame.confidence = confidence;
  }
  return recording;
}

}  // namespace palpable::layouts

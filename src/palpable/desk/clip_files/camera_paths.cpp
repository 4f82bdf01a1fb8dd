#include "palpable/desk/clip_files/camera_paths.h"

#include "palpable/common/base/error.h"
#include "palpable/common/base/order_statistics.h"
#include "palpable/common/base/text_numbers.h"
#include "palpable/common/base/time_stamps.h"
#include "palpable/desk/clip_files/text_file.h"
#include "palpable/live/sources/folder_layouts.h"
#include "palpable/live/sources/natural_order.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <sstream>
#include <system_error>
#include <utility>

namespace palpable {
namespace {

namespace fs = std::filesystem;

StampedPose stamped_pose_of(const std::string& line) {
  if (has_decimal_commas(line)) throw Error(std::string(kDecimalCommas));
  const std::optional<std::vector<double>> n = to_numbers(line);
  // to_numbers() also accepts brackets and semicolons, which this format does not have.
  if (!n || n->size() != 8 || line.find_first_of("[];") != std::string::npos) {
    throw Error("8 numbers are wanted: time tx ty tz qx qy qz qw");
  }
  const Eigen::Quaterniond q((*n)[7], (*n)[4], (*n)[5], (*n)[6]);
  if (!(std::abs(q.norm() - 1) < 0.01)) {
    throw Error(fmt::format("the quaternion has length {:.4g}, not 1", q.norm()));
  }
  StampedPose pose;
  pose.time = (*n)[0];
  pose.world_from_camera =
      Eigen::Translation3d((*n)[1], (*n)[2], (*n)[3]) * Eigen::Quaterniond(q.normalized());
  return pose;
}

constexpr double kKittiRate = 10;        // Hz
constexpr double kSevenScenesRate = 30;  // Hz
constexpr std::string_view kPoseEnding = ".pose.txt";

// The pose in a matrix of 3 x 4 or 4 x 4 numbers, row by row. @throws Error when it holds no
// rotation
Rigid3 pose_of_rows(const std::vector<double>& n, const std::string& where) {
  using Rows = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;
  Rigid3 pose = Rigid3::Identity();
  pose.matrix().topRows<3>() = Eigen::Map<const Rows>(n.data());
  const Eigen::Matrix3d R = pose.linear();
  constexpr double kRounding = 1e-2;  // of R^T R from 1; files have few digits
  const double off = (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(off <= kRounding) || R.determinant() < 0) {
    throw Error(fmt::format("{}: the matrix holds no rotation", where));
  }
  pose.linear() = Eigen::Quaterniond(R).normalized().toRotationMatrix();
  return pose;
}

std::vector<std::string> lines_of(const fs::path& path) {
  Result<std::vector<std::string>> lines = read_lines(path);
  if (!lines) throw Error(fmt::format("{}: {}", path.string(), lines.problem().message));
  return std::move(lines).value();
}

// @throws Error for a line that would be read as more numbers than it has
void refuse_decimal_commas(const fs::path& path, const std::vector<std::string>& lines) {
  for (const std::string& line : lines) {
    if (!has_decimal_commas(line)) continue;
    throw Error(fmt::format("{}: '{}' {}", path.string(), line.substr(0, 40), kDecimalCommas));
  }
}

PublishedPoses kitti(const fs::path& file, const std::vector<std::string>& lines,
                     std::optional<double> rate) {
  refuse_decimal_commas(file, lines);
  PublishedPoses published{"KITTI", "left camera", {}};
  const fs::path clock = file.parent_path() / "times.txt";
  std::optional<std::vector<std::string>> times;
  if (std::error_code ignored; !rate && fs::exists(clock, ignored)) times = lines_of(clock);
  if (times && times->size() < lines.size()) {
    throw Error(fmt::format("{}: has {} times for the {} poses of {}; --fps takes their place",
                            clock.string(), times->size(), lines.size(), file.string()));
  }
  for (std::size_t k = 0; k < lines.size(); ++k) {
    const std::string where = fmt::format("{}: line {}", file.string(), k + 1);
    const auto n = to_numbers(lines[k]);
    if (!n || n->size() != 12) {
      throw Error(fmt::format("{}: 12 numbers are wanted, the rows of world_from_camera", where));
    }
    std::optional<double> time = static_cast<double>(k) / rate.value_or(kKittiRate);
    if (times) time = to_number((*times)[k]);
    if (!time) { throw Error(fmt::format("{}: line {}: is no time", clock.string(), k + 1)); }
    published.poses.push_back({*time, pose_of_rows(*n, where)});
  }
  return published;
}

std::vector<fs::path> pose_files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (it->path().filename().string().ends_with(kPoseEnding)) files.push_back(it->path());
  }
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return natural_less(a.filename().string(), b.filename().string());
  });
  return files;
}

PublishedPoses seven_scenes(const std::vector<fs::path>& files, std::optional<double> rate) {
  PublishedPoses published{"7-Scenes", "depth camera", {}};
  for (const fs::path& file : files) {
    std::string text;
    const std::vector<std::string> lines = lines_of(file);
    refuse_decimal_commas(file, lines);
    for (const std::string& line : lines) text += line + "\n";
    const auto n = to_numbers(text);
    if (!n || n->size() != 16) {
      throw Error(
          fmt::format("{}: 16 numbers are wanted, the rows of world_from_camera", file.string()));
    }
    const double number = static_cast<double>(published.poses.size());
    published.poses.push_back(
        {number / rate.value_or(kSevenScenesRate), pose_of_rows(*n, file.string())});
  }
  return published;
}

PublishedPoses of_recording(const fs::path& folder) {
  const Recording recording = value_or_throw(recognise_folder(folder));
  PublishedPoses published{recording.layout, "left camera", {}};
  for (const RecordedFrame& frame : recording.frames) {
    if (!frame.world_from_camera || !frame.time) continue;
    published.poses.push_back({recording.starts_at + *frame.time, *frame.world_from_camera});
  }
  return published;
}

PublishedPoses euroc(const fs::path& csv) {
  // If the file lies in a recording, sensor.yaml gives the camera's pose in the body, so that the
  // poses can be those of the left camera.
  std::error_code ignored;
  const fs::path recording = fs::absolute(csv, ignored).parent_path().parent_path();
  if (fs::exists(recording / "cam0/sensor.yaml", ignored) &&
      fs::is_directory(recording / "cam0/data", ignored)) {
    return of_recording(recording);
  }
  refuse_decimal_commas(csv, lines_of(csv));
  PublishedPoses published{"EuRoC", "body", {}};
  for (const auto& [time, pose] : read_euroc_poses(csv, 0)) published.poses.push_back({time, pose});
  return published;
}

PublishedPoses of_text(const fs::path& file, std::optional<double> rate) {
  const std::vector<std::string> lines = lines_of(file);
  const auto n = lines.empty() ? std::nullopt : to_numbers(lines.front());
  if (!lines.empty() && has_decimal_commas(lines.front())) {
    throw Error(fmt::format("{}: its first line {}", file.string(), kDecimalCommas));
  }
  if (n && n->size() == 8) return {"TUM", "left camera", read_trajectory(file)};
  if (n && n->size() == 12) return kitti(file, lines, rate);
  throw Error(fmt::format(
      "{}: holds no poses that are known: lines of 8 numbers (TUM: time tx ty tz qx qy qz qw) or "
      "12 "
      "(KITTI), a *.pose.txt of 7-Scenes, EuRoC's data.csv, or a folder of one of these",
      file.string()));
}

std::vector<double> times_of(const std::vector<StampedPose>& poses) {
  std::vector<double> times;
  for (const StampedPose& pose : poses) times.push_back(pose.time);
  return times;
}

// Whether a camera's path has whole times that are 10 to 1000 apart: milliseconds.
bool look_like_milliseconds(const std::vector<double>& times) {
  constexpr std::size_t kSome = 10;
  if (times.size() < kSome) return false;
  const bool whole =
      std::all_of(times.begin(), times.end(), [](double t) { return t == std::floor(t); });
  const double mean_step = (times.back() - times.front()) / static_cast<double>(times.size() - 1);
  return whole && mean_step >= 10 && mean_step < 1000;
}

void expect_seconds(const fs::path& path, const std::vector<double>& times) {
  const std::string wrong = what_is_wrong_with_times(times);
  if (!wrong.empty()) throw Error(fmt::format("{}: {}", path.string(), wrong));
  if (!look_like_milliseconds(times)) return;
  throw Error(fmt::format(
      "{}: the times are {} to {}, {} poses with {:.0f} from one to the next, which looks like "
      "milliseconds: they should be seconds, so divide them by 1000",
      path.string(), times.front(), times.back(), times.size(),
      (times.back() - times.front()) / static_cast<double>(times.size() - 1)));
}

PublishedPoses read_any(const fs::path& path, std::optional<double> rate) {
  std::error_code ignored;
  if (!fs::exists(path, ignored)) throw Error(fmt::format("{}: is not there", path.string()));
  if (fs::is_directory(path, ignored)) {
    const std::vector<fs::path> files = pose_files_in(path);
    return files.empty() ? of_recording(path) : seven_scenes(files, rate);
  }
  if (path.filename().string().ends_with(kPoseEnding)) {
    return seven_scenes(pose_files_in(fs::absolute(path, ignored).parent_path()), rate);
  }
  // Of phones: the poses of Stray Scanner and of Record3D, in their folders.
  if (path.filename() == "odometry.csv" || path.filename() == "metadata.json") {
    return of_recording(fs::absolute(path, ignored).parent_path());
  }
  return path.extension() == ".csv" ? euroc(path) : of_text(path, rate);
}

// Refuses positions in millimetres: those whose median speed is above 200 m/s.
void expect_metres(const fs::path& path, const std::vector<StampedPose>& poses) {
  constexpr double kFastest = 200;  // m/s
  std::vector<double> speeds;
  for (std::size_t k = 1; k < poses.size(); ++k) {
    const Eigen::Vector3d way =
        poses[k].world_from_camera.translation() - poses[k - 1].world_from_camera.translation();
    speeds.push_back(way.norm() / (poses[k].time - poses[k - 1].time));
  }
  if (speeds.empty()) return;
  const double median = upper_median(speeds);
  if (!(median > kFastest)) return;
  throw Error(fmt::format(
      "{}: the camera moves by {:.3g} m in a second (median): positions are to be in metres, times "
      "in seconds",
      path.string(), median));
}

}  // namespace

std::string trajectory_line(const StampedPose& pose) {
  const Eigen::Vector3d t = pose.world_from_camera.translation();
  const Eigen::Quaterniond q(pose.world_from_camera.linear());
  return fmt::format("{:.6f} {:.7f} {:.7f} {:.7f} {:.9f} {:.9f} {:.9f} {:.9f}\n", pose.time, t.x(),
                     t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
}

std::vector<StampedPose> read_trajectory(const std::filesystem::path& path) {
  std::vector<StampedPose> poses;
  for_each_line(path, [&](const std::string& line) {
    if (line.front() == '#') return;
    const StampedPose pose = stamped_pose_of(line);
    if (!poses.empty() && !(pose.time > poses.back().time)) {
      throw Error(
          fmt::format("times must rise: {} s comes after {} s", pose.time, poses.back().time));
    }
    poses.push_back(pose);
  });
  const std::string wrong = what_is_wrong_with_times(times_of(poses));
  if (!wrong.empty()) throw Error(fmt::format("{}: {}", path.string(), wrong));
  expect_metres(path, poses);
  return poses;
}

PublishedPoses read_published_poses(const fs::path& path, std::optional<double> rate) {
  PublishedPoses published = read_any(path, rate);
  if (published.poses.size() < 2) {
    throw Error(fmt::format("{}: holds {} poses; two at least are wanted", path.string(),
                            published.poses.size()));
  }
  for (std::size_t k = 1; k < published.poses.size(); ++k) {
    const double before = published.poses[k - 1].time;
    if (!(published.poses[k].time > before)) {
      throw Error(fmt::format("{}: times must rise: {} s comes after {} s", path.string(),
                              published.poses[k].time, before));
    }
  }
  expect_seconds(path, times_of(published.poses));
  expect_metres(path, published.poses);
  return published;
}

}  // namespace palpable

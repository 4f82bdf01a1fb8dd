// KITTI: https://www.cvlibs.net/datasets/kitti, odometry
#include "palpable/common/base/text_numbers.h"
#include "palpable/common/base/time_stamps.h"
#include "palpable/live/calibrate/calibration_check.h"
#include "palpable/live/sources/layouts.h"

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpable::layouts {
namespace {

namespace fs = std::filesystem;

// Describes times that are not seconds; empty if there are none.
std::string wrong_kitti_times(const std::vector<std::string>& lines) {
  std::vector<double> times;
  for (const std::string& line : lines) {
    if (const auto time = to_number(line)) times.push_back(*time);
  }
  return what_is_wrong_with_times(times);
}

using Projection = std::vector<double>;  // 12 numbers, row by row

PinholeCamera camera_of(const Projection& P) { return {0, 0, P[0], P[5], P[2], P[6]}; }

// Why two projections cannot be those of rectified left and right cameras; empty if they can. The
// right camera may stand above or below the left one by 5 % of the baseline; KITTI's own files have
// 0.7 %.
std::string contradiction_of(const Projection& L, const Projection& R) {
  std::string wrong = what_contradicts(camera_of(L), camera_of(R));
  if (wrong.empty() && !(std::abs(R[7] - L[7]) <= 0.05 * std::abs(R[3] - L[3]))) {
    wrong = fmt::format("the heights of the two eyes, which differ by {:.3g} m",
                        std::abs(R[7] - L[7]) / L[5]);
  }
  return wrong;
}

// Reads the projections P0 and P1, or P2 and P3, from lines `P0: 12 numbers`; some copies lack the
// names and have them in order.
Result<std::array<Projection, 2>> projections_of(const fs::path& path, std::size_t first) {
  const std::vector<std::string> lines = lines_in(path);
  if (lines.empty()) {
    return Problem{fmt::format("{} has no calib.txt with the projections P0, P1, ...",
                               path.parent_path().string())};
  }
  std::array<Projection, 4> named;
  std::vector<Projection> in_order;
  for (std::string_view line : lines) {
    std::optional<std::size_t> name;
    if (line.size() > 3 && line[0] == 'P' && line[1] >= '0' && line[1] <= '3' && line[2] == ':') {
      name = static_cast<std::size_t>(line[1] - '0');
      line.remove_prefix(3);
    }
    const auto n = to_numbers(line);
    if (!n || n->size() != 12) continue;
    if (!name) {
      in_order.push_back(*n);
    } else if (named[*name].empty() || named[*name] == *n) {
      named[*name] = *n;
    } else {
      return Problem{fmt::format("{} has P{} twice, with different numbers", path.string(), *name)};
    }
  }
  std::array<Projection, 2> eyes{named[first], named[first + 1]};
  if (eyes[0].empty() && eyes[1].empty() && in_order.size() >= first + 2) {
    eyes = {in_order[first], in_order[first + 1]};
  }
  if (eyes[0].empty() || eyes[1].empty()) {
    return Problem{fmt::format("{} has no lines `P{}: ` and `P{}: ` of 12 numbers", path.string(),
                               first, first + 1)};
  }
  if (const std::string wrong = contradiction_of(eyes[0], eyes[1]); !wrong.empty()) {
    return Problem{fmt::format("{}: {}, contradict each other: no pair of rectified eyes",
                               path.string(), wrong)};
  }
  return eyes;
}

Result<Recording> kitti_recording(const fs::path& folder, std::string_view left,
                                  std::string_view right) {
  Result<Recording> pairs =
      pair_up(folder, "KITTI", ImagePair::kLeftRight, {images_in(folder / left), left},
              {images_in(folder / right), right});
  if (!pairs.ok()) return pairs;
  Recording& recording = pairs.value();
  const fs::path path = folder / "calib.txt";
  const Result<std::array<Projection, 2>> eyes = projections_of(path, left == "image_2" ? 2 : 0);
  if (!eyes.ok()) return eyes.problem();
  const auto& [L, R] = eyes.value();
  SourceCalibration calibration;
  calibration.file = path.string();
  FrameFormat& format = calibration.format;
  format.already_rectified = true;
  // The image size is not in the file; it is read from the first image when the folder is opened.
  format.rectified = {camera_of(L), (L[3] - R[3]) / L[0], L[2] - R[2]};
  constexpr double kUsualRate = 10;  // Hz
  calibration.frames_per_second = kUsualRate;
  const std::vector<std::string> times = lines_in(folder / "times.txt");
  if (times.empty() && recording.frames.size() > 1) {
    calibration.guesses.push_back(
        fmt::format("{} has no times.txt: KITTI's usual rate of {} Hz is assumed", folder.string(),
                    kUsualRate));
  }
  recording.calibration = calibration;

  const std::vector<std::string> poses = lines_in(folder / "poses.txt");
  const std::string wrong = wrong_kitti_times(times);
  if (!wrong.empty()) {
    return Problem{fmt::format("{}: {}", (folder / "times.txt").string(), wrong)};
  }
  for (std::size_t i = 0; i < recording.frames.size(); ++i) {
    RecordedFrame& frame = recording.frames[i];
    frame.time = static_cast<double>(i) / kUsualRate;
    if (i < times.size()) frame.time = to_number(times[i]);
    if (!frame.time) {
      return Problem{fmt::format("{}: '{}' is no time in seconds", (folder / "times.txt").string(),
                                 times[i].substr(0, 40))};
    }
    if (i >= poses.size()) continue;
    frame.world_from_camera = pose_of(to_numbers(poses[i]).value_or(std::vector<double>{}));
    if (!frame.world_from_camera) continue;
    // The poses are those of camera 0, and the left camera may be beside it: K t = 4th column of P.
    const double x = -L[3] / L[0];
    *frame.world_from_camera = *frame.world_from_camera * Eigen::Translation3d(x, 0, 0);
  }
  return pairs;
}

}  // namespace

Recognised kitti(const fs::path& folder) {
  constexpr std::array kSides{std::pair{"image_0", "image_1"}, std::pair{"image_2", "image_3"},
                              std::pair{"image_l", "image_r"}};
  for (const auto& [left, right] : kSides) {
    if (is_folder(folder / left) && is_folder(folder / right)) {
      return kitti_recording(folder, left, right);
    }
  }
  return std::nullopt;
}

}  // namespace palpable::layouts

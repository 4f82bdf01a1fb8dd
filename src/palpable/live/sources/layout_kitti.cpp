// KITTI: https://www.cvlibs.net/datasets/kitti, odometry
#include "palpable/common/base/text_numbers.h"
#include "palpable/live/sources/layouts.h"

#include <fmt/core.h>

#include <array>
#include <utility>

namespace palpable::layouts {
namespace {

namespace fs = std::filesystem;

Result<Recording> kitti_recording(const fs::path& folder, std::string_view left,
                                  std::string_view right) {
  Result<Recording> pairs =
      pair_up(folder, "KITTI", ImagePair::kLeftRight, {images_in(folder / left), left},
              {images_in(folder / right), right});
  if (!pairs.ok()) return pairs;
  Recording& recording = pairs.value();
  // P0: the 12 numbers of a projection in row order; some copies lack the names.
  const fs::path path = folder / "calib.txt";
  const auto lines = read_lines(path);
  if (!lines) {
    return Problem{
        fmt::format("{} has no calib.txt with the projections P0, P1, ...", folder.string())};
  }
  std::vector<std::vector<double>> projections;
  for (std::string_view line : *lines) {
    if (line.starts_with('P') && line.find(':') != std::string_view::npos) {
      line.remove_prefix(line.find(':') + 1);
    }
    const auto n = to_numbers(line);
    if (n && n->size() == 12) projections.push_back(*n);
  }
  const std::size_t first = left == "image_2" ? 2 : 0;
  if (projections.size() < first + 2) {
    return Problem{fmt::format("{} has {} projections of 12 numbers; {} of them are needed",
                               path.string(), projections.size(), first + 2)};
  }
  const std::vector<double>& L = projections[first];
  const std::vector<double>& R = projections[first + 1];
  SourceCalibration calibration;
  FrameFormat& format = calibration.format;
  format.already_rectified = true;
  // The image size is not in the file; it is read from the first image when the folder is opened.
  format.rectified = {{0, 0, L[0], L[5], L[2], L[6]}, (L[3] - R[3]) / L[0], L[2] - R[2]};
  calibration.frames_per_second = 10;
  recording.calibration = calibration;

  const auto times = read_lines(folder / "times.txt");
  const auto poses = read_lines(folder / "poses.txt");
  for (std::size_t i = 0; i < recording.frames.size(); ++i) {
    RecordedFrame& frame = recording.frames[i];
    frame.time = static_cast<double>(i) / calibration.frames_per_second;
    if (times && i < times->size()) frame.time = to_number((*times)[i]).value_or(*frame.time);
    if (!poses || i >= poses->size()) continue;
    frame.world_from_camera = pose_of(to_numbers((*poses)[i]).value_or(std::vector<double>{}));
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

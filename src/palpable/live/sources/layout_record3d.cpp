// Record3D, an app for iPhones with a depth sensor: https://record3d.app. The formats:
// github.com/marek-simonik/record3d/issues/27, 33 and 36.
#include "palpable/common/base/bounded_text.h"
#include "palpable/common/base/json.h"
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

// The numbers of a list of numbers; empty for anything else.
std::vector<double> numbers_of(const Json& list) {
  std::vector<double> numbers;
  for (const Json& value : list) {
    const std::optional<double> number = value.if_number();
    if (!number) return {};
    numbers.push_back(*number);
  }
  return numbers;
}

// Rows of numbers, one for each frame; empty without the key.
std::vector<std::vector<double>> rows_of(const Json& metadata, const char* key) {
  std::vector<std::vector<double>> rows;
  if (!metadata.contains(key)) return rows;
  for (const Json& row : metadata[key]) rows.push_back(numbers_of(row));
  return rows;
}

double number_of(const Json& metadata, const char* key) {
  const Json* value = metadata.find(key);
  return value != nullptr ? value->if_number().value_or(0) : 0;
}

// K column by column, as the app writes it, or row by row.
std::optional<FrameLens> lens_of_matrix(const std::vector<double>& K) {
  if (K.size() != 9 || K[1] != 0 || K[3] != 0) return std::nullopt;
  const bool by_columns = K[2] == 0 && K[5] == 0;
  return FrameLens{K[0], K[4], by_columns ? K[6] : K[2], by_columns ? K[7] : K[5]};
}

Result<SourceCalibration> record3d_calibration(const Json& metadata, const fs::path& path,
                                               std::vector<std::string>& notes) {
  std::vector<FrameLens> lenses;
  for (const std::vector<double>& n : rows_of(metadata, "perFrameIntrinsicCoeffs")) {
    if (n.size() == 4) lenses.push_back({n[0], n[1], n[2], n[3]});
  }
  std::optional<FrameLens> lens;
  if (!lenses.empty()) {
    lens = median_lens(lenses, path.string(), notes);
  } else if (metadata.contains("K")) {
    lens = lens_of_matrix(numbers_of(metadata["K"]));
  }
  if (!lens || !(lens->fx > 0) || !(lens->fy > 0)) {
    return Problem{fmt::format(
        "{} is no metadata of Record3D: it should have K, nine numbers, or perFrameIntrinsicCoeffs",
        path.string())};
  }
  SourceCalibration calibration = lens_calibration(*lens, path.string());
  const double width = number_of(metadata, "w"), height = number_of(metadata, "h");
  if (is_image_side(width) && is_image_side(height)) {
    set_size(calibration.format, static_cast<int>(width), static_cast<int>(height));
  }
  if (const double rate = number_of(metadata, "fps"); rate > 0 && rate < 10000) {
    calibration.frames_per_second = rate;
    calibration.rate_is_stated = true;
  }
  return calibration;
}

// Poses are qx qy qz qw x y z of the camera in the world, with OpenGL's axes of the camera: Y up, Z
// backwards.
std::optional<Rigid3> pose_of_row(const std::vector<double>& n) {
  if (n.size() != 7) return std::nullopt;
  Rigid3 pose = pose_of(Eigen::Vector3d(n[4], n[5], n[6]), n[3], n[0], n[1], n[2]);
  pose.linear() = pose.linear() * Eigen::Vector3d(1, -1, -1).asDiagonal();
  return pose;
}

std::map<long long, fs::path> first_kind(const fs::path& folder,
                                         const std::vector<const char*>& endings) {
  for (const char* ending : endings) {
    std::map<long long, fs::path> files = numbered_files(folder, ending);
    if (!files.empty()) return files;
  }
  return {};
}

Result<Recording> exported_recording(const fs::path& folder) {
  const fs::path path = folder / "metadata.json";
  const Result<std::string> text = read_bounded_text(path, Notation::kJson);
  if (!text.ok()) return text.problem();
  const Result<Json> parsed = Json::parse(text.value());
  if (!parsed.ok()) return Problem{fmt::format("{}: {}", path.string(), parsed.problem().message)};
  const Json& metadata = parsed.value();
  Recording recording;
  recording.layout = "Record3D";
  recording.pair = ImagePair::kColorDepth;
  recording.depth_unit = 1e-3;  // of PNG files that somebody wrote; the app's own are in metres
  recording.calibrates_color = true;
  Result<SourceCalibration> calibration = record3d_calibration(metadata, path, recording.notes);
  if (!calibration.ok()) return calibration.problem();
  recording.calibration = std::move(calibration).value();
  const std::map<long long, fs::path> colors =
      first_kind(folder / "rgb", {".jpg", ".png", ".jpeg"});
  const std::map<long long, fs::path> depths = first_kind(folder / "depth", {".exr", ".png"});
  const std::vector<std::vector<double>> poses = rows_of(metadata, "poses");
  const std::vector<double> times = metadata.contains("frameTimestamps")
                                        ? numbers_of(metadata["frameTimestamps"])
                                        : std::vector<double>{};
  for (const auto& [number, color] : colors) {
    const auto depth = depths.find(number);
    const auto n = static_cast<std::size_t>(number);
    if (depth == depths.end() || (!times.empty() && times.size() <= n)) {
      ++recording.unmatched;
      continue;
    }
    RecordedFrame& frame = recording.frames.emplace_back();
    frame.first = color;
    frame.second = depth->second;
    if (times.size() > n) frame.time = times[n];
    if (poses.size() > n) frame.world_from_camera = pose_of_row(poses[n]);
  }
  return recording;
}

}  // namespace

Recognised record3d(const fs::path& folder) {
  if (is_folder(folder / "rgbd") && is_there(folder / "metadata")) {
    return Problem{fmt::format("{} {}", folder.string(), kPackedRecord3d)};
  }
  for (const fs::path& exported : {folder, folder / "EXR_RGBD"}) {
    if (is_there(exported / "metadata.json") && is_folder(exported / "rgb") &&
        is_folder(exported / "depth")) {
      return exported_recording(exported);
    }
  }
  return std::nullopt;
}

}  // namespace palpable::layouts

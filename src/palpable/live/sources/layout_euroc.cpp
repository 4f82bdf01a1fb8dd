// EuRoC: https://projects.asl.ethz.ch/datasets
#include "palpable/common/base/text_numbers.h"
#include "palpable/live/calibrate/rectification.h"
#include "palpable/live/sources/layouts.h"

#include <fmt/format.h>

#include <algorithm>

namespace palpable {
namespace layouts {
namespace {

namespace fs = std::filesystem;

// The numbers in the first [...] after `key:`; empty if there is none.
std::vector<double> list_after(const std::string& text, std::string_view key) {
  const auto at = text.find(std::string(key) + ":");
  if (at == std::string::npos) return {};
  const auto from = text.find('[', at);
  const auto to = text.find(']', at);
  if (from == std::string::npos || to == std::string::npos || to < from) return {};
  return to_numbers(std::string_view(text).substr(from, to - from)).value_or(std::vector<double>{});
}

struct EurocCamera {
  DistortedCamera lens;
  Rigid3 body_from_camera = Rigid3::Identity();
  double rate = 20;
};

Result<EurocCamera> read_euroc_camera(const fs::path& path) {
  const std::vector<std::string> lines = lines_in(path);
  const std::string text = fmt::format("{}", fmt::join(lines, "\n"));
  const auto size = list_after(text, "resolution");
  const auto f = list_after(text, "intrinsics");
  const auto k = list_after(text, "distortion_coefficients");
  const auto pose = pose_of(list_after(text, "T_BS"));
  if (size.size() != 2 || f.size() != 4 || k.size() != 4 || !pose) {
    return Problem{fmt::format(
        "{} is no EuRoC camera: it should have resolution, intrinsics, distortion_coefficients "
        "and T_BS",
        path.string())};
  }
  if (!is_image_side(size[0]) || !is_image_side(size[1])) {
    return Problem{fmt::format("{} has an image of {} x {} px", path.string(), size[0], size[1])};
  }
  for (const std::string& line : lines) {
    if (!line.starts_with("distortion_model:")) continue;
    if (line.find("radial-tangential") != std::string::npos ||
        line.find("radtan") != std::string::npos) {
      continue;
    }
    return Problem{
        fmt::format("{}: {}: only radial-tangential lenses are understood; rectify the "
                    "images first, or calibrate again and name the file with --calibration",
                    path.string(), line)};
  }
  EurocCamera camera;
  camera.lens = {{static_cast<int>(size[0]), static_cast<int>(size[1]), f[0], f[1], f[2], f[3]},
                 {k[0], k[1], k[2], k[3], 0}};
  camera.body_from_camera = *pose;
  for (const std::string& line : lines) {
    if (!line.starts_with("rate_hz:")) continue;
    const auto rate = to_numbers(std::string_view(line).substr(8));
    if (rate && rate->size() == 1 && rate->front() > 0) camera.rate = rate->front();
  }
  return camera;
}

constexpr double kNanosecond = 1e-9;  // s

// -1 if the text is not a time stamp.
long long nanoseconds(std::string_view text) {
  return std::max(to_whole_number(text).value_or(-1), -1LL);
}

// The rig from the sensor.yaml of both cameras.
Result<SourceCalibration> euroc_calibration(const fs::path& folder) {
  for (const char* file : {"cam0/sensor.yaml", "cam1/sensor.yaml"}) {
    if (!is_there(folder / file)) {
      return Problem{fmt::format(
          "{} is laid out as EuRoC is but has no {}: name a calibration with --calibration",
          folder.string(), file)};
    }
  }
  const Result<EurocCamera> left = read_euroc_camera(folder / "cam0/sensor.yaml");
  if (!left.ok()) return left.problem();
  const Result<EurocCamera> right = read_euroc_camera(folder / "cam1/sensor.yaml");
  if (!right.ok()) return right.problem();
  SourceCalibration calibration;
  calibration.file = fmt::format("{} and {}", (folder / "cam0/sensor.yaml").string(),
                                 (folder / "cam1/sensor.yaml").string());
  calibration.format.rig = {
      left.value().lens, right.value().lens,
      right.value().body_from_camera.inverse() * left.value().body_from_camera};
  const Result<RectifiedGeometry> geometry = rectify_rig(calibration.format.rig);
  if (!geometry.ok()) {
    return Problem{fmt::format("{}: {}", calibration.file, geometry.problem().message)};
  }
  calibration.format.width = left.value().lens.pinhole.width;
  calibration.format.height = left.value().lens.pinhole.height;
  calibration.frames_per_second = left.value().rate;
  return calibration;
}

Result<Recording> euroc_recording(const fs::path& folder) {
  Recording recording;
  recording.layout = "EuRoC";
  const Result<SourceCalibration> calibration = euroc_calibration(folder);
  if (calibration.ok()) {
    recording.calibration = calibration.value();
  } else {
    recording.calibration_trouble = calibration.problem().message;
  }
  const Result<EurocCamera> first = read_euroc_camera(folder / "cam0/sensor.yaml");
  const Rigid3 body_from_camera = first.ok() ? first.value().body_from_camera : Rigid3::Identity();

  // Times are relative to the first image, because 1e18 ns exceed a double's precision.
  const std::vector<fs::path> lefts = images_in(folder / "cam0/data");
  const long long begin = lefts.empty() ? 0 : nanoseconds(lefts.front().stem().string());
  recording.starts_at = kNanosecond * static_cast<double>(begin);
  const std::map<double, Rigid3> poses =
      read_euroc_poses(folder / "state_groundtruth_estimate0/data.csv", begin);
  for (const fs::path& image : lefts) {
    const fs::path partner = folder / "cam1/data" / image.filename();
    const long long stamp = nanoseconds(image.stem().string());
    if (stamp < 0 || !is_there(partner)) {
      ++recording.unmatched;
      continue;
    }
    const double time = kNanosecond * static_cast<double>(stamp - begin);
    RecordedFrame& frame = recording.frames.emplace_back();
    frame.first = image;
    frame.second = partner;
    frame.time = time;
    if (const Rigid3* world_from_body = nearest(poses, time)) {
      frame.world_from_camera = *world_from_body * body_from_camera;
    }
  }
  return recording;
}

}  // namespace

Recognised euroc(const fs::path& folder) {
  for (const fs::path& euroc_folder : {folder / "mav0", folder}) {
    if (is_there(euroc_folder / "cam0/sensor.yaml") ||
        (is_folder(euroc_folder / "cam0/data") && is_folder(euroc_folder / "cam1/data"))) {
      return euroc_recording(euroc_folder);
    }
  }
  return std::nullopt;
}

}  // namespace layouts

std::map<double, Rigid3> read_euroc_poses(const std::filesystem::path& csv, long long begin) {
  std::map<double, Rigid3> poses;
  for (const std::string& line : layouts::lines_in(csv)) {
    const auto n = to_numbers(line);
    if (!n || n->size() < 8) continue;
    const long long stamp = layouts::nanoseconds(std::string_view(line).substr(0, line.find(',')));
    if (stamp < 0) continue;
    const double time = layouts::kNanosecond * static_cast<double>(stamp - begin);
    poses[time] = layouts::pose_of(Eigen::Vector3d((*n)[1], (*n)[2], (*n)[3]), (*n)[4], (*n)[5],
                                   (*n)[6], (*n)[7]);
  }
  return poses;
}

}  // namespace palpable

#include "palpable/live/sources/calibration_partner.h"

#include "palpable/live/calibrate/ros_camera_info.h"
#include "palpable/live/sources/natural_order.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostSearched = 60;  // files of a folder; calibrations lie among few

// Files that may be calibrations, in natural order.
std::vector<fs::path> candidates_in(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  const fs::path here = folder.empty() ? fs::path(".") : folder;
  for (fs::directory_iterator it(here, error), end; !error && it != end; it.increment(error)) {
    const std::string ending = it->path().extension().string();
    std::error_code ignored;
    if ((ending == ".yml" || ending == ".yaml" || ending == ".xml" || ending == ".json" ||
         ending == ".conf" || ending == ".txt") &&
        it->is_regular_file(ignored)) {
      files.push_back(folder / it->path().filename());
    }
  }
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return natural_less(a.filename().string(), b.filename().string());
  });
  if (files.size() > kMostSearched) files.resize(kMostSearched);
  return files;
}

using WordPair = std::pair<std::string_view, std::string_view>;

constexpr std::array<WordPair, 5> kHalves{WordPair{"intrinsics", "extrinsics"},
                                          {"intrinsic", "extrinsic"},
                                          {"Intrinsics", "Extrinsics"},
                                          {"Intrinsic", "Extrinsic"},
                                          {"INTRINSICS", "EXTRINSICS"}};
constexpr std::array<WordPair, 11> kEyes{WordPair{"left", "right"},
                                         {"Left", "Right"},
                                         {"LEFT", "RIGHT"},
                                         {"cam0", "cam1"},
                                         {"camera0", "camera1"},
                                         {"infra1", "infra2"},
                                         {"_l.", "_r."},
                                         {"_L.", "_R."},
                                         {"_0.", "_1."},
                                         {"-l.", "-r."},
                                         {"L.", "R."}};

struct OtherName {
  std::string name;
  bool is_second = false;  // the given name is the second's
};

// The names with one word of a pair exchanged for the other, at its last place.
template <std::size_t N>
std::vector<OtherName> other_names(const std::string& name, const std::array<WordPair, N>& words) {
  std::vector<OtherName> names;
  for (const auto& [first, second] : words) {
    for (const bool is_second : {false, true}) {
      const std::string_view from = is_second ? second : first, to = is_second ? first : second;
      const std::size_t at = name.rfind(from);
      if (at == std::string::npos) continue;
      std::string other = name;
      other.replace(at, from.size(), to);
      names.push_back({other, is_second});
    }
  }
  return names;
}

bool is_other_half(const CalibrationText& half, const CalibrationText& other) {
  if (half.kind == CalibrationKind::kOpencvLenses)
    return other.kind == CalibrationKind::kOpencvPose;
  if (half.kind == CalibrationKind::kOpencvPose)
    return other.kind == CalibrationKind::kOpencvLenses;
  return other.kind == half.kind;
}

struct Found {
  CalibrationText other;
  std::optional<bool> is_second = std::nullopt;  // whether the given one is the second, by its name
};

// The only other half in the folder.
Result<Found> only_other(const CalibrationText& half, const std::string& wanted) {
  std::vector<CalibrationText> others;
  for (const fs::path& path : candidates_in(half.path.parent_path())) {
    if (path.filename() == half.path.filename()) continue;
    Result<CalibrationText> file = open_calibration(path);
    if (file.ok() && is_other_half(half, file.value())) others.push_back(std::move(file).value());
  }
  if (others.size() == 1) return Found{others.front()};
  if (others.empty()) {
    return Problem{fmt::format("calibration {} {}", half.path.string(), wanted)};
  }
  return Problem{fmt::format("calibration {} {}; {} and {} could both be it", half.path.string(),
                             wanted, others[0].path.filename().string(),
                             others[1].path.filename().string())};
}

template <std::size_t N>
Result<Found> other_half(const CalibrationText& half, const std::array<WordPair, N>& words,
                         const std::string& wanted) {
  std::error_code error;
  std::optional<bool> is_second;
  for (const OtherName& name : other_names(half.path.filename().string(), words)) {
    if (!is_second) is_second = name.is_second;
    const fs::path path = half.path.parent_path() / name.name;
    if (!fs::is_regular_file(path, error)) continue;
    Result<CalibrationText> file = open_calibration(path);
    if (!file.ok()) return file.problem();
    if (is_other_half(half, file.value())) return Found{file.value(), name.is_second};
  }
  Result<Found> found = only_other(half, wanted);
  if (found.ok()) found.value().is_second = is_second;
  return found;
}

// In ROS's projection of a right eye P[3] is not 0.
bool is_right_by_projection(const CalibrationText& file) {
  const auto camera = read_ros_camera(file.keys);
  return camera.ok() && camera.value().projection(0, 3) != 0;
}

Result<CalibrationPair> eyes_of_ros(const CalibrationText& half) {
  const Result<Found> found = other_half(
      half, kEyes,
      "is a camera file of one eye (ROS, OpenCV's sample calibration); put that of the other eye, "
      "calibrated with it, beside it (ROS's left.yaml and "
      "right.yaml), or make a calibration with palpable calibrate");
  if (!found.ok()) return found.problem();
  const bool is_right = found.value().is_second.value_or(is_right_by_projection(half));
  if (is_right) return CalibrationPair{found.value().other, half};
  return CalibrationPair{half, found.value().other};
}

// Whether a file in a folder may hold what is wanted.
bool may_be(const CalibrationText& file, std::optional<FrameFormat::Kind> kind) {
  switch (file.kind) {
    case CalibrationKind::kNotRead:
      return false;
    case CalibrationKind::kIntrinsics: {
      const fs::path name = file.path.filename();
      return kind != FrameFormat::Kind::kStereo &&
             (name == "intrinsics.txt" || name == "camera-intrinsics.txt");
    }
    case CalibrationKind::kCameraJson:
      return kind != FrameFormat::Kind::kStereo;
    case CalibrationKind::kRosCamera:
    case CalibrationKind::kCamchain:
    case CalibrationKind::kRealsenseJson:
    case CalibrationKind::kRealsenseListing:
      return true;
    default:  // stereo rigs
      return kind != FrameFormat::Kind::kColorDepth;
  }
}

}  // namespace

Result<CalibrationPair> pair_of(const CalibrationText& half) {
  if (half.kind == CalibrationKind::kRosCamera) return eyes_of_ros(half);
  const bool has_lenses = half.kind == CalibrationKind::kOpencvLenses;
  const Result<Found> found = other_half(
      half, kHalves,
      has_lenses
          ? "has the lenses of both eyes (OpenCV's sample stereo_calib) but not R and T: put "
            "its extrinsics.yml beside it"
          : "has R and T of both eyes (OpenCV's sample stereo_calib) but no lenses: put its "
            "intrinsics.yml (M1 D1 M2 D2) beside it");
  if (!found.ok()) return found.problem();
  if (has_lenses) return CalibrationPair{half, found.value().other};
  return CalibrationPair{found.value().other, half};
}

Result<CalibrationText> calibration_in(const fs::path& folder,
                                       std::optional<FrameFormat::Kind> kind) {
  std::vector<CalibrationText> found;
  std::string faults;
  for (const fs::path& path : candidates_in(folder)) {
    Result<CalibrationText> file = open_calibration(path);
    if (!file.ok() || !may_be(file.value(), kind)) continue;
    // Of a pair the first file stands for both.
    const bool alone = kind == FrameFormat::Kind::kColorDepth || !is_half(file.value().kind);
    if (!alone) {
      const Result<CalibrationPair> pair = pair_of(file.value());
      if (!pair.ok()) {
        faults = pair.problem().message;
        continue;
      }
      if (pair.value().first.path != path) continue;
    }
    found.push_back(std::move(file).value());
  }
  if (found.size() == 1) return found.front();
  if (found.empty()) {
    if (!faults.empty()) return Problem{faults};
    return Problem{fmt::format(
        "folder {} has no calibration: looked for were *.yml, *.yaml, *.xml, *.json, *.conf and "
        "intrinsics.txt of OpenCV, ROS, Kalibr, RealSense, ZED or palpable calibrate",
        folder.string())};
  }
  return Problem{fmt::format("folder {} has several calibrations, {} and {}: name one of them",
                             folder.string(), found[0].path.filename().string(),
                             found[1].path.filename().string())};
}

}  // namespace palpable

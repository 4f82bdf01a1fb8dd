#include "palpable/live/sources/folder_layouts.h"

#include "palpable/common/base/text_numbers.h"
#include "palpable/live/calibrate/rectification.h"
#include "palpable/live/sources/image_file.h"
#include "palpable/live/sources/name_pattern.h"
#include "palpable/live/sources/natural_order.h"
#include "palpable/live/sources/side_by_side.h"
#include "palpable/live/sources/video_file_source.h"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <functional>
#include <map>
#include <string_view>
#include <system_error>
#include <utility>

namespace palpable {
namespace {

namespace fs = std::filesystem;

constexpr double kSameMoment = 0.02;  // s, the limit of TUM's own tool

// The images directly in `folder` that match the pattern, in natural order.
std::vector<fs::path> images_in(const fs::path& folder, std::string_view pattern = "*") {
  std::vector<fs::path> images;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    std::error_code ignored;
    const std::string name = it->path().filename().string();
    if (name.front() != '.' && matches_pattern(name, pattern) && is_image_name(it->path()) &&
        it->is_regular_file(ignored)) {
      images.push_back(it->path());
    }
  }
  std::sort(images.begin(), images.end(), [](const fs::path& a, const fs::path& b) {
    return natural_less(a.filename().string(), b.filename().string());
  });
  return images;
}

bool is_there(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

bool is_folder(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored);
}

// The last number in a name before its extension; empty without a number.
std::optional<long long> number_in(const fs::path& image) {
  const std::string name = image.stem().string();
  const auto last = name.find_last_of("0123456789");
  if (last == std::string::npos) return std::nullopt;
  const auto before = name.find_last_not_of("0123456789", last);
  const std::size_t from = before == std::string::npos ? 0 : before + 1;
  return to_whole_number(std::string_view(name).substr(from, last + 1 - from));
}

// The first image whose number does not occur on the other side, if most numbers occur on
// both sides, so that they number the frames. Empty otherwise: then each side has its own
// stamps or counters.
std::optional<fs::path> without_partner(const std::vector<fs::path>& first,
                                        const std::vector<fs::path>& second) {
  std::map<long long, int> sides;  // bit 0: in the first, bit 1: in the second
  std::map<long long, const fs::path*> images;
  for (const auto* list : {&first, &second}) {
    for (const fs::path& image : *list) {
      const std::optional<long long> number = number_in(image);
      if (!number) return std::nullopt;
      sides[*number] |= list == &first ? 1 : 2;
      images[*number] = &image;
    }
  }
  const auto alone = [](const auto& side) { return side.second != 3; };
  const auto both =
      static_cast<std::size_t>(std::count_if(sides.begin(), sides.end(), std::not_fn(alone)));
  const auto odd = std::find_if(sides.begin(), sides.end(), alone);
  if (odd == sides.end() || 2 * both <= first.size()) return std::nullopt;
  return *images.at(odd->first);
}

// Pairs the images by their index; a problem when one has no partner.
std::optional<Problem> join(const fs::path& folder, const std::vector<fs::path>& first,
                            const std::vector<fs::path>& second, std::string_view first_name,
                            std::string_view second_name, Recording& recording) {
  if (first.size() != second.size()) {
    return Problem{
        fmt::format("{} has {} {} and {} {} images; each needs its partner, so add or "
                    "remove what is left over",
                    folder.string(), first.size(), first_name, second.size(), second_name)};
  }
  if (const std::optional<fs::path> odd = without_partner(first, second)) {
    return Problem{
        fmt::format("{} has no partner of its number among the {} and {} images of {}; "
                    "add what is missing or remove what is left over",
                    odd->filename().string(), first_name, second_name, folder.string())};
  }
  for (std::size_t i = 0; i < first.size(); ++i) {
    recording.frames.push_back({first[i], second[i], std::nullopt, std::nullopt});
  }
  return std::nullopt;
}

Rigid3 pose_of(const Eigen::Vector3d& position, double qw, double qx, double qy, double qz) {
  Rigid3 pose = Rigid3::Identity();
  pose.linear() = Eigen::Quaterniond(qw, qx, qy, qz).normalized().toRotationMatrix();
  pose.translation() = position;
  return pose;
}

// A pose from 12 or 16 numbers in row order.
std::optional<Rigid3> pose_of(const std::vector<double>& n) {
  if (n.size() != 12 && n.size() != 16) return std::nullopt;
  Rigid3 pose = Rigid3::Identity();
  pose.matrix().topRows<3>() =
      Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(n.data());
  return pose;
}

// The entry nearest to `time`, if it is within kSameMoment; else null.
template <class T>
const T* nearest(const std::map<double, T>& entries, double time) {
  const auto after = entries.lower_bound(time);
  const T* best = nullptr;
  double distance = kSameMoment;
  for (auto it : {after, after == entries.begin() ? after : std::prev(after)}) {
    if (it == entries.end() || std::abs(it->first - time) > distance) continue;
    distance = std::abs(it->first - time);
    best = &it->second;
  }
  return best;
}

void count_from_first(Recording& recording) {
  if (recording.frames.empty()) return;
  const double begin = recording.frames.front().time.value_or(0);
  recording.starts_at += begin;
  for (RecordedFrame& frame : recording.frames) {
    if (frame.time) *frame.time -= begin;
  }
}

// --- EuRoC: https://projects.asl.ethz.ch/datasets ----------------------------------------------

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
  const auto lines = read_lines(path);
  std::string text;
  for (const std::string& line : lines.value_or(std::vector<std::string>{})) text += line + "\n";
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
  for (const std::string& line : *lines) {
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
  for (const std::string& line : *lines) {
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
  calibration.format.rig = {
      left.value().lens, right.value().lens,
      right.value().body_from_camera.inverse() * left.value().body_from_camera};
  const Result<RectifiedGeometry> geometry = rectify_rig(calibration.format.rig);
  if (!geometry.ok()) {
    return Problem{fmt::format("{} and {}: {}", (folder / "cam0/sensor.yaml").string(),
                               (folder / "cam1/sensor.yaml").string(), geometry.problem().message)};
  }
  calibration.format.width = left.value().lens.pinhole.width;
  calibration.format.height = left.value().lens.pinhole.height;
  calibration.frames_per_second = left.value().rate;
  return calibration;
}

Result<Recording> euroc(const fs::path& folder) {
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

// --- KITTI: https://www.cvlibs.net/datasets/kitti, odometry ------------------------------------

Result<Recording> kitti(const fs::path& folder, std::string_view left, std::string_view right) {
  Recording recording;
  recording.layout = "KITTI";
  if (auto problem = join(folder, images_in(folder / left), images_in(folder / right), left, right,
                          recording)) {
    return *problem;
  }
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
  return recording;
}

// --- TUM: https://cvg.cit.tum.de/data/datasets/rgbd-dataset ------------------------------------

// Reads lines like "1305031102.1758 rgb/1305031102.1758.png", sorted by stamp. Lines without a
// stamp, or with the stamp of an earlier line, are skipped and counted.
std::map<double, fs::path> stamped_files(const fs::path& folder, const char* list, int& left_out) {
  std::map<double, fs::path> files;
  const auto lines = read_lines(folder / list);
  for (const std::string& line : lines.value_or(std::vector<std::string>{})) {
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

Result<Recording> tum(const fs::path& folder) {
  Recording recording;
  recording.layout = "TUM";
  recording.pair = ImagePair::kColorDepth;
  recording.depth_unit = 1 / 5000.0;
  std::map<double, Rigid3> poses;
  const auto truth = read_lines(folder / "groundtruth.txt");
  for (const std::string& line : truth.value_or(std::vector<std::string>{})) {
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

// --- 7-Scenes: https://www.microsoft.com/en-us/research/project/rgb-d-dataset-7-scenes ---------

constexpr const char* kSevenScenes = "7-Scenes";
const PinholeCamera kSevenScenesDepth{0, 0, 585, 585, 320, 240};

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

Result<Recording> seven_scenes(const fs::path& folder) {
  Recording recording;
  recording.layout = kSevenScenes;
  recording.pair = ImagePair::kColorDepth;
  if (auto problem = join(folder, images_in(folder, "frame-*.color.*"),
                          images_in(folder, "frame-*.depth.*"), "colour", "depth", recording)) {
    return *problem;
  }
  for (RecordedFrame& frame : recording.frames) {
    std::string name = frame.first.filename().string();
    name = name.substr(0, name.find(".color"));
    std::string text;
    const auto lines = read_lines(folder / (name + ".pose.txt"));
    for (const std::string& line : lines.value_or(std::vector<std::string>{})) text += line + "\n";
    frame.world_from_camera = pose_of(to_numbers(text).value_or(std::vector<double>{}));
  }
  if (!is_there(folder / "camera-intrinsics.txt") && !is_there(folder / "intrinsics.txt")) {
    SourceCalibration& calibration = recording.calibration.emplace();
    calibration.format.kind = FrameFormat::Kind::kColorDepth;
    calibration.format.depth_camera = kSevenScenesDepth;
    calibration.format.color_sensor = seven_scenes_color();
  }
  return recording;
}

// --- Palpable's own layouts ---------------------------------------------------------------------

Result<Recording> two_folders(const fs::path& folder) {
  Recording recording;
  recording.layout = "left/ and right/";
  const std::vector<fs::path> left = images_in(folder / "left");
  const std::vector<fs::path> right = images_in(folder / "right");
  if (left.empty() && right.empty()) {
    return Problem{fmt::format("{} has no images in left/ and right/", folder.string())};
  }
  if (auto problem = join(folder, left, right, "left", "right", recording)) return *problem;
  return recording;
}

Result<Recording> color_and_depth(const fs::path& folder, const std::vector<fs::path>& depth) {
  Recording recording;
  recording.layout = "colour + depth";
  recording.pair = ImagePair::kColorDepth;
  std::vector<fs::path> color = images_in(folder, "color_*");
  if (color.empty()) color = images_in(folder, "rgb_*");
  if (auto problem = join(folder, color, depth, "colour", "depth", recording)) return *problem;
  return recording;
}

// --- Middlebury: https://vision.middlebury.edu/stereo/data, and pairs with similar names ---------

// The value of `key=` in Middlebury's calib.txt; empty if there is none.
std::vector<double> middlebury_numbers(const std::vector<std::string>& lines,
                                       std::string_view key) {
  for (const std::string& line : lines) {
    if (!line.starts_with(key) || line.substr(key.size(), 1) != "=") continue;
    std::string numbers = line.substr(key.size() + 1);
    std::replace_if(
        numbers.begin(), numbers.end(), [](char c) { return c == '[' || c == ']' || c == ';'; },
        ' ');
    return to_numbers(numbers).value_or(std::vector<double>{});
  }
  return {};
}

// Reads calib.txt of Middlebury's sets since 2014 and of ETH3D's pairs: cam0=[f 0 cx; 0 f cy; 0 0
// 1], doffs (px), baseline (mm), width, height. A problem when the file has another content.
Result<SourceCalibration> middlebury_calibration(const fs::path& path) {
  const std::vector<std::string> lines = read_lines(path).value_or(std::vector<std::string>{});
  const auto one = [&](std::string_view key) {
    const std::vector<double> numbers = middlebury_numbers(lines, key);
    return numbers.size() == 1 ? numbers.front() : std::nan("");
  };
  const std::vector<double> K = middlebury_numbers(lines, "cam0");
  const double baseline = 1e-3 * one("baseline");
  const double doffs = one("doffs");
  const double width = one("width");
  const double height = one("height");
  constexpr double kLongestBaseline = 10;  // m
  if (K.size() != 9 || !(K[0] > 0 && K[4] > 0) || !std::isfinite(doffs) ||
      !(baseline > 0 && baseline < kLongestBaseline) || !is_image_side(width) ||
      !is_image_side(height)) {
    return Problem{fmt::format(
        "{} is no calib.txt of Middlebury: it should have cam0=[f 0 cx; 0 f cy; 0 0 1], doffs= "
        "(px), baseline= (mm), width= and height=",
        path.string())};
  }
  SourceCalibration calibration;
  calibration.format.already_rectified = true;
  calibration.format.rectified = {
      {static_cast<int>(width), static_cast<int>(height), K[0], K[4], K[2], K[5]}, baseline, doffs};
  calibration.format.width = calibration.format.rectified.camera.width;
  calibration.format.height = calibration.format.rectified.camera.height;
  return calibration;
}

// The pair im0 and im1, imL and imR, or view1 and view5; empty if there is none.
std::optional<Recording> named_pair(const std::vector<fs::path>& images) {
  constexpr std::array kNames{std::pair{"im0", "im1"}, std::pair{"imL", "imR"},
                              std::pair{"view1", "view5"}};
  const auto called = [&](std::string_view stem) {
    return std::find_if(images.begin(), images.end(),
                        [&](const fs::path& image) { return image.stem() == stem; });
  };
  for (const auto& [left, right] : kNames) {
    const auto first = called(left);
    const auto second = called(right);
    if (first == images.end() || second == images.end()) continue;
    Recording recording;
    recording.layout = fmt::format("{} and {}", left, right);
    recording.frames.push_back({*first, *second, {}, {}});
    const fs::path calibration = first->parent_path() / "calib.txt";
    if (!is_there(calibration)) return recording;
    const Result<SourceCalibration> read = middlebury_calibration(calibration);
    if (read.ok()) {
      recording.calibration = read.value();
    } else {
      recording.calibration_trouble = read.problem().message;
    }
    return recording;
  }
  return std::nullopt;
}

// Whether the size of a picture is that of two eyes side by side.
bool shows_two_eyes(const fs::path& image) {
  ImageFileReader reader;
  ColorImage picture;
  return reader.read_color(image, picture).ok() &&
         looks_side_by_side(picture.width(), picture.height());
}

// *_0 and *_1, *_left and *_right, *_L and *_R: pairs, if every image of the folder has its partner
// and does not have the size of two eyes side by side; else empty.
std::optional<Recording> ended_pairs(const std::vector<fs::path>& images) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 3> kEndings{
      std::pair{"_0", "_1"}, std::pair{"_left", "_right"}, std::pair{"_L", "_R"}};
  for (const auto& [left, right] : kEndings) {
    Recording recording;
    recording.layout = fmt::format("*{} and *{}", left, right);
    std::map<std::string, fs::path> rights;  // by the name before the ending
    std::vector<std::pair<std::string, fs::path>> lefts;
    for (const fs::path& image : images) {
      const std::string stem = image.stem().string();
      if (stem.ends_with(left)) {
        lefts.emplace_back(stem.substr(0, stem.size() - left.size()), image);
      } else if (stem.ends_with(right)) {
        rights.emplace(stem.substr(0, stem.size() - right.size()), image);
      }
    }
    if (lefts.empty() || lefts.size() != rights.size() || 2 * lefts.size() != images.size()) {
      continue;
    }
    for (const auto& [base, image] : lefts) {
      const auto partner = rights.find(base);
      if (partner != rights.end()) recording.frames.push_back({image, partner->second, {}, {}});
    }
    if (recording.frames.size() != lefts.size()) continue;
    if (lefts.size() == 1 && shows_two_eyes(lefts.front().second)) continue;
    return recording;
  }
  return std::nullopt;
}

Result<Recording> side_by_side(const fs::path& folder, const std::vector<fs::path>& images) {
  Recording recording;
  recording.layout = "side by side";
  recording.pair = ImagePair::kSideBySide;
  if (images.empty()) {
    return Problem{fmt::format("{} has no images in a layout that is known. {}", folder.string(),
                               known_layouts())};
  }
  for (const fs::path& image : images) recording.frames.push_back({image, {}, {}, {}});
  return recording;
}

Result<Recording> recognise(const fs::path& folder) {
  for (const fs::path& euroc_folder : {folder / "mav0", folder}) {
    if (is_there(euroc_folder / "cam0/sensor.yaml") ||
        (is_folder(euroc_folder / "cam0/data") && is_folder(euroc_folder / "cam1/data"))) {
      return euroc(euroc_folder);
    }
  }
  constexpr std::array kKitti{std::pair{"image_0", "image_1"}, std::pair{"image_2", "image_3"},
                              std::pair{"image_l", "image_r"}};
  for (const auto& [left, right] : kKitti) {
    if (is_folder(folder / left) && is_folder(folder / right)) return kitti(folder, left, right);
  }
  if (is_there(folder / "rgb.txt") && is_there(folder / "depth.txt")) return tum(folder);
  if (!images_in(folder, "frame-*.depth.*").empty()) return seven_scenes(folder);
  if (is_folder(folder / "left") || is_folder(folder / "right")) return two_folders(folder);
  const std::vector<fs::path> depth = images_in(folder, "depth_*");
  if (!depth.empty()) return color_and_depth(folder, depth);
  const std::vector<fs::path> left = images_in(folder, "left*");
  const std::vector<fs::path> right = images_in(folder, "right*");
  if (!left.empty() && !right.empty()) {
    Recording recording;
    recording.layout = "left* and right*";
    if (auto problem = join(folder, left, right, "left", "right", recording)) return *problem;
    return recording;
  }
  const std::vector<fs::path> images = images_in(folder);
  if (std::optional<Recording> pair = named_pair(images)) return *std::move(pair);
  if (std::optional<Recording> pairs = ended_pairs(images)) return *std::move(pairs);
  return side_by_side(folder, images);
}

void find_calibration_files(const fs::path& folder, Recording& recording) {
  for (const char* name :
       {"calibration.yml", "rectified.yml", "intrinsics.txt", "camera-intrinsics.txt"}) {
    const bool of_depth = std::string_view(name).ends_with("intrinsics.txt");
    if (of_depth == (recording.pair == ImagePair::kColorDepth) && is_there(folder / name)) {
      recording.calibration_files.push_back(folder / name);
    }
  }
  if (recording.pair == ImagePair::kColorDepth || !recording.calibration_files.empty()) return;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (matches_pattern(it->path().filename().string(), "SN*.conf")) {
      recording.calibration_files.push_back(it->path());
    }
  }
}

}  // namespace

std::map<double, Rigid3> read_euroc_poses(const fs::path& csv, long long begin) {
  std::map<double, Rigid3> poses;
  const auto truth = read_lines(csv);
  for (const std::string& line : truth.value_or(std::vector<std::string>{})) {
    const auto n = to_numbers(line);
    if (!n || n->size() < 8) continue;
    const long long stamp = nanoseconds(std::string_view(line).substr(0, line.find(',')));
    if (stamp < 0) continue;
    const double time = kNanosecond * static_cast<double>(stamp - begin);
    poses[time] =
        pose_of(Eigen::Vector3d((*n)[1], (*n)[2], (*n)[3]), (*n)[4], (*n)[5], (*n)[6], (*n)[7]);
  }
  return poses;
}

std::string_view known_layouts() {
  return "Read are: left/ and right/; left* and right*; imL and imR, im0 and im1, view1 and view5; "
         "*_0 and *_1, *_left and *_right, *_L and *_R; pairs side by side in one picture; color_* "
         "or rgb_* with depth_* (16-bit images); folders of EuRoC, KITTI, TUM and 7-Scenes; or "
         "name "
         "images: --source \"a*.png\" --right \"b*.png\" (docs/recordings.md)";
}

std::optional<ColorSensor> color_sensor_of(const Recording& recording,
                                           const PinholeCamera& depth_camera) {
  if (recording.layout == kSevenScenes && depth_camera.fx_px == kSevenScenesDepth.fx_px) {
    return seven_scenes_color();
  }
  return std::nullopt;
}

Result<Recording> recognise_folder(const fs::path& folder) {
  if (!is_there(folder)) { return Problem{fmt::format("there is no folder {}", folder.string())}; }
  if (!is_folder(folder)) {
    return Problem{
        fmt::format("{} is not a folder, and its name does not end like a video's ({}) "
                    "or an image's (.png .jpg .bmp .ppm .pgm .tif)",
                    folder.string(), fmt::join(kVideoEndings, " "))};
  }
  Result<Recording> recognised = recognise(folder);
  if (!recognised.ok()) return recognised;
  Recording& recording = recognised.value();
  if (recording.frames.empty()) {
    return Problem{fmt::format("{} looks like {} but no two of its images belong together",
                               folder.string(), recording.layout)};
  }
  count_from_first(recording);
  find_calibration_files(folder, recording);
  return recognised;
}

bool is_image_name(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  constexpr std::array<std::string_view, 8> kKnown = {".png", ".jpg", ".jpeg", ".bmp",
                                                      ".ppm", ".pgm", ".tif",  ".tiff"};
  return std::find(kKnown.begin(), kKnown.end(), extension) != kKnown.end();
}

bool is_pattern(const fs::path& path) {
  return path.filename().string().find_first_of("*?") != std::string::npos;
}

Result<Recording> recognise_patterns(const fs::path& first, const fs::path& second,
                                     bool second_is_depth) {
  const auto found = [](const fs::path& pattern) {
    const fs::path folder = pattern.parent_path().empty() ? "." : pattern.parent_path();
    return images_in(folder, pattern.filename().string());
  };
  const std::vector<fs::path> firsts = found(first);
  if (firsts.empty()) { return Problem{fmt::format("no image is called {}", first.string())}; }
  Recording recording;
  if (second.empty()) {
    recording = std::move(side_by_side(first, firsts)).value();
  } else {
    const std::vector<fs::path> seconds = found(second);
    recording.pair = second_is_depth ? ImagePair::kColorDepth : ImagePair::kLeftRight;
    recording.layout = second_is_depth ? "colour + depth" : "left and right";
    if (seconds.empty()) return Problem{fmt::format("no image is called {}", second.string())};
    if (auto problem =
            join(first, firsts, seconds, second_is_depth ? "colour" : "left",
                 fmt::format("{} {}", second.string(), second_is_depth ? "depth" : "right"),
                 recording)) {
      return *problem;
    }
  }
  find_calibration_files(first.parent_path().empty() ? "." : first.parent_path(), recording);
  return recording;
}

}  // namespace palpable

#include "palpable/live/sources/folder_layouts.h"

#include "palpable/common/base/text_numbers.h"
#include "palpable/live/sources/layouts.h"
#include "palpable/live/sources/name_pattern.h"
#include "palpable/live/sources/video_file_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <system_error>

namespace palpable {
namespace {

namespace fs = std::filesystem;

// The layouts in the order in which they are tried: those of data sets with files or folders of
// their own come before those that go by the names of images.
constexpr std::array kLayouts{
    &layouts::euroc,      &layouts::kitti,      &layouts::tum,          &layouts::openloris,
    &layouts::stray,      &layouts::record3d,   &layouts::seven_scenes, &layouts::palpable_pairs,
    &layouts::middlebury, &layouts::ended_pairs};

void count_from_first(Recording& recording) {
  if (recording.frames.empty()) return;
  const double begin = recording.frames.front().time.value_or(0);
  recording.starts_at += begin;
  for (RecordedFrame& frame : recording.frames) {
    if (frame.time) *frame.time -= begin;
  }
}

Recording side_by_side(const std::vector<fs::path>& images) {
  Recording recording;
  recording.layout = "side by side";
  recording.pair = ImagePair::kSideBySide;
  for (const fs::path& image : images) recording.frames.push_back({image, {}, {}, {}});
  return recording;
}

Result<Recording> recognise(const fs::path& folder) {
  for (const auto layout : kLayouts) {
    if (layouts::Recognised recognised = layout(folder)) return *std::move(recognised);
  }
  Recording recording = side_by_side(layouts::images_in(folder));
  if (!recording.frames.empty()) return recording;
  return Problem{fmt::format("{} has no images in a layout that is known. {}", folder.string(),
                             known_layouts())};
}

void find_calibration_files(const fs::path& folder, Recording& recording) {
  for (const char* name :
       {"calibration.yml", "rectified.yml", "intrinsics.txt", "camera-intrinsics.txt"}) {
    const bool of_depth = std::string_view(name).ends_with("intrinsics.txt");
    if (of_depth == (recording.pair == ImagePair::kColorDepth) &&
        layouts::is_there(folder / name)) {
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

// The texts of the layouts. One that is there but cannot be read, such as a text in UTF-16, is
// refused: without it, frames would lose their times or poses.
std::string unreadable_text(const fs::path& folder) {
  constexpr std::array kTexts{"rgb.txt",           "depth.txt",         "groundtruth.txt",
                              "times.txt",         "poses.txt",         "calib.txt",
                              "color.txt",         "aligned_depth.txt", "sensors.yaml",
                              "trans_matrix.yaml", "odometry.csv",      "camera_matrix.csv"};
  constexpr std::array kOfEuroc{"cam0/sensor.yaml", "cam1/sensor.yaml",
                                "state_groundtruth_estimate0/data.csv"};
  std::vector<fs::path> paths;
  for (const char* name : kTexts) paths.push_back(folder / name);
  for (const char* name : kOfEuroc) {
    paths.push_back(folder / name);
    paths.push_back(folder / "mav0" / name);
  }
  for (const fs::path& path : paths) {
    if (!layouts::is_there(path)) continue;
    const Result<std::vector<std::string>> lines = read_lines(path);
    if (!lines) return fmt::format("{}: {}", path.string(), lines.problem().message);
    for (const std::string& line : lines.value()) {
      if (has_decimal_commas(line)) {
        return fmt::format("{}: '{}' {}", path.string(), line.substr(0, 40), kDecimalCommas);
      }
    }
  }
  return {};
}

}  // namespace

std::string_view known_layouts() {
  return "Read are: left/ and right/; left* and right*; imL and imR, im0 and im1, view1 and view5; "
         "*_0 and *_1, *_left and *_right, *_L and *_R; pairs side by side in one picture; color_* "
         "or rgb_* with depth_* (16-bit images), also as folders color/ or rgb/ with depth/; "
         "folders of EuRoC, KITTI, TUM, Bonn, OpenLORIS, 7-Scenes, Stray Scanner and Record3D "
         "(EXR + RGB); or name images: --source \"a*.png\" --right \"b*.png\" (docs/recordings.md)";
}

Result<Recording> recognise_folder(const fs::path& folder) {
  if (!layouts::is_there(folder)) {
    return Problem{fmt::format("there is no folder {}", folder.string())};
  }
  if (folder.extension() == ".r3d") {
    return Problem{fmt::format("{} {}", folder.string(), layouts::kPackedRecord3d)};
  }
  if (!layouts::is_folder(folder)) {
    return Problem{
        fmt::format("{} is not a folder, and its name does not end like a video's ({}) "
                    "or an image's (.png .jpg .bmp .ppm .pgm .tif)",
                    folder.string(), fmt::join(kVideoEndings, " "))};
  }
  if (const std::string why = unreadable_text(folder); !why.empty()) return Problem{why};
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
    return layouts::images_in(folder, pattern.filename().string());
  };
  const std::vector<fs::path> firsts = found(first);
  if (firsts.empty()) { return Problem{fmt::format("no image is called {}", first.string())}; }
  Result<Recording> recording = side_by_side(firsts);
  if (!second.empty()) {
    const std::vector<fs::path> seconds = found(second);
    if (seconds.empty()) return Problem{fmt::format("no image is called {}", second.string())};
    const std::string name =
        fmt::format("{} {}", second.string(), second_is_depth ? "depth" : "right");
    recording = second_is_depth ? layouts::pair_up(first, "colour + depth", ImagePair::kColorDepth,
                                                   {firsts, "colour"}, {seconds, name})
                                : layouts::pair_up(first, "left and right", ImagePair::kLeftRight,
                                                   {firsts, "left"}, {seconds, name});
    if (!recording.ok()) return recording;
  }
  find_calibration_files(first.parent_path().empty() ? "." : first.parent_path(),
                         recording.value());
  return recording;
}

}  // namespace palpable

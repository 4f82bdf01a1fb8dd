// Palpable's own layouts.
#include "palpable/live/sources/layouts.h"

#include <fmt/core.h>

namespace palpable::layouts {
namespace {

namespace fs = std::filesystem;

Result<Recording> two_folders(const fs::path& folder) {
  const std::vector<fs::path> left = images_in(folder / "left");
  const std::vector<fs::path> right = images_in(folder / "right");
  if (left.empty() && right.empty()) {
    return Problem{fmt::format("{} has no images in left/ and right/", folder.string())};
  }
  return pair_up(folder, "left/ and right/", ImagePair::kLeftRight, {left, "left"},
                 {right, "right"});
}

// The images of a folder by their number, or OpenEXR files of depth.
std::map<long long, fs::path> numbered_images(const fs::path& folder) {
  std::map<long long, fs::path> images = numbered_files(folder, ".exr");
  for (const char* ending : {".png", ".tiff", ".tif", ".pgm", ".jpg", ".jpeg", ".bmp", ".ppm"}) {
    if (images.empty()) images = numbered_files(folder, ending);
  }
  return images;
}

// color/ or rgb/ with depth/. Pictures belong together by their number only: two folders whose
// numbers differ, such as stamps, need a list.
Recognised color_and_depth_folders(const fs::path& folder) {
  if (!is_folder(folder / "depth")) return std::nullopt;
  for (const char* name : {"color", "rgb"}) {
    const std::map<long long, fs::path> colors = numbered_images(folder / name);
    const std::map<long long, fs::path> depths = numbered_images(folder / "depth");
    if (colors.empty() || depths.empty()) continue;
    Recording recording;
    recording.layout = fmt::format("{}/ and depth/", name);
    recording.pair = ImagePair::kColorDepth;
    for (const auto& [number, color] : colors) {
      const auto depth = depths.find(number);
      if (depth != depths.end()) recording.frames.push_back({color, depth->second, {}, {}});
    }
    if (2 * recording.frames.size() <= colors.size()) {
      return Problem{fmt::format(
          "{}: the pictures of {}/ and depth/ have other numbers in their names: write rgb.txt and "
          "depth.txt, `seconds file` in each line, to pair them by their times",
          folder.string(), name)};
    }
    recording.unmatched = static_cast<int>(colors.size() - recording.frames.size());
    return recording;
  }
  return std::nullopt;
}

}  // namespace

Recognised palpable_pairs(const fs::path& folder) {
  if (is_folder(folder / "left") || is_folder(folder / "right")) return two_folders(folder);
  std::vector<fs::path> depth = images_in(folder, "depth_*");
  if (depth.empty()) depth = images_in(folder, "depth_*.exr");
  if (!depth.empty()) {
    std::vector<fs::path> color = images_in(folder, "color_*");
    if (color.empty()) color = images_in(folder, "rgb_*");
    return pair_up(folder, "colour + depth", ImagePair::kColorDepth, {color, "colour"},
                   {depth, "depth"});
  }
  if (Recognised folders = color_and_depth_folders(folder)) return folders;
  const std::vector<fs::path> left = images_in(folder, "left*");
  const std::vector<fs::path> right = images_in(folder, "right*");
  if (left.empty() || right.empty()) return std::nullopt;
  return pair_up(folder, "left* and right*", ImagePair::kLeftRight, {left, "left"},
                 {right, "right"});
}

}  // namespace palpable::layouts

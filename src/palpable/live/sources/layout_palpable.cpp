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

}  // namespace

Recognised palpable_pairs(const fs::path& folder) {
  if (is_folder(folder / "left") || is_folder(folder / "right")) return two_folders(folder);
  if (const std::vector<fs::path> depth = images_in(folder, "depth_*"); !depth.empty()) {
    std::vector<fs::path> color = images_in(folder, "color_*");
    if (color.empty()) color = images_in(folder, "rgb_*");
    return pair_up(folder, "colour + depth", ImagePair::kColorDepth, {color, "colour"},
                   {depth, "depth"});
  }
  const std::vector<fs::path> left = images_in(folder, "left*");
  const std::vector<fs::path> right = images_in(folder, "right*");
  if (left.empty() || right.empty()) return std::nullopt;
  return pair_up(folder, "left* and right*", ImagePair::kLeftRight, {left, "left"},
                 {right, "right"});
}

}  // namespace palpable::layouts

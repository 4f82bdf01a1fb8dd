// Pairs by the ends of their names.
#include "palpable/live/sources/image_file.h"
#include "palpable/live/sources/layouts.h"
#include "palpable/live/sources/side_by_side.h"

#include <fmt/core.h>

#include <array>
#include <utility>

namespace palpable::layouts {
namespace {

namespace fs = std::filesystem;

// Whether the size of a picture is that of two eyes side by side.
bool shows_two_eyes(const fs::path& image) {
  ImageFileReader reader;
  ColorImage picture;
  return reader.read_color(image, picture).ok() &&
         looks_side_by_side(picture.width(), picture.height());
}

}  // namespace

// *_0 and *_1, *_left and *_right, *_L and *_R: pairs, if every image of the folder has its
// partner; else empty. The numbers 0 and 1 may also be those of two frames with both eyes side by
// side.
Recognised ended_pairs(const fs::path& folder) {
  const std::vector<fs::path> images = images_in(folder);
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
    recording.may_be_two_frames =
        lefts.size() == 1 && left == "_0" && shows_two_eyes(lefts.front().second);
    return recording;
  }
  return std::nullopt;
}

}  // namespace palpable::layouts

#include "palpable/desk/clip_files/true_view.h"

#include "palpable/desk/clip_files/depth_image_file.h"
#include "palpable/desk/clip_files/frame_names.h"
#include "palpable/desk/clip_files/mask_image_file.h"

#include <algorithm>
#include <utility>

namespace palpable {

std::optional<TrueView> read_true_view(const std::filesystem::path& truth, int frame, double unit) {
  const std::string name = frame_name(frame, ".png");
  const auto depth = read_depth_counts(truth / "depth" / name);
  auto labels = read_labels(truth / "labels" / name);
  if (!depth || !labels) return std::nullopt;
  std::transform(labels->begin(), labels->end(), labels->begin(), [](std::uint8_t label) {
    return (label & kMovesLabel) != 0 ? kShowsPresser : kShowsRoom;
  });
  return TrueView{depth_of(*depth, unit), std::move(*labels)};
}

}  // namespace palpable

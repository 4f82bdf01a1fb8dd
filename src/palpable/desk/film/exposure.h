/// @file
/// How the picture of an open shutter is put together from pictures of single moments.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/desk/film/desk_moment.h"

#include <utility>

namespace palpable {

/// The pictures that an exposure is the mean of. Its time is divided three times:
///
///     |       reference 0       |       reference 1       |   paints what stands still
///     |  layer 0   |  layer 1   |  layer 2   |  layer 3   |   paints the movers
///     | look| look | look| look | look| look | look| look |   looks at the reference, turned
///
/// Each is made for the middle of its time. A look sees the reference as the eye sees it when it
/// has turned until then.
struct Exposure {
  double opens = 0, closes = 0;  ///< frames
  int references = 1;
  int layers = 1;      ///< in a reference
  int looks = 1;       ///< in a layer
  bool turns = false;  ///< the eye turns by so much that looks differ

  [[nodiscard]] bool is_one_moment() const { return references * layers * looks == 1; }
  /// The middle of share `i` of `count`, frames.
  [[nodiscard]] double middle(int i, int count) const {
    return opens + (closes - opens) * (i + 0.5) / count;
  }
};

/// Upper bounds of the layers, and of the looks, of all references together.
inline constexpr int kMostLayers = 20, kMostLooks = 30;

/// The movers as the shutter opens and as it closes: the same things in the same order. Where
/// something appears or vanishes in between, both are the movers of the frame's own moment.
[[nodiscard]] std::pair<Movers, Movers> movers_between(const DeskMoment& frame, double opens,
                                                       double closes);

/// Divides an eye's exposure so that between neighbours
///
///     references  near things shift by at most 2 px against far ones,
///     looks       the eye's turn moves the picture by at most 2 px,
///     layers      the movers' picture moves by at most 4 px: skin has little texture.
///
/// There are at most ten references; since divisions are rounded up, less than twenty layers and
/// less than thirty looks. Compared with steps three to four times as fine, the pictures of
/// blur-hand differ by 0.2 grey levels on average (0.1 with 1.5, 1.5 and 3 px) and by 0.7 in the
/// worst of ten frames: no more than the noise.
/// @param view  the eye without its lens
[[nodiscard]] Exposure split_exposure(const PinholeCamera& view, const Rigid3& eye_from_camera,
                                      const DeskMoment& frame);

}  // namespace palpable

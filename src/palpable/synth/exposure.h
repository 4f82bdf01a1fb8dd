/// @file
/// What the picture of an open shutter is put together from: so many pictures, no more.
#pragma once

#include "palpable/geometry/camera.h"
#include "palpable/geometry/rigid.h"
#include "palpable/synth/desk_renderer.h"

#include <utility>

namespace palpable {

/// What an exposure is the mean of: equal shares of its time, each with a picture of what stands
/// still (a reference); in each of them layers of movers; under each layer looks at the reference.
struct Exposure {
  double opens = 0, closes = 0;  ///< frames
  int references = 1;
  int layers = 1;      ///< of a reference
  int looks = 1;       ///< of a layer
  bool turns = false;  ///< else one look serves a whole reference

  [[nodiscard]] bool is_one_moment() const { return references * layers * looks == 1; }
  /// The middle of share `i` of `count`, frames.
  [[nodiscard]] double middle(int i, int count) const {
    return opens + (closes - opens) * (i + 0.5) / count;
  }
};

/// Layers of all references together, and their looks: no more than these.
inline constexpr int kMostLayers = 20, kMostLooks = 30;

/// What moves, as the shutter opens and as it closes, the same things in the same order. What
/// appears or vanishes in between stands as it does in the frame's own moment.
[[nodiscard]] std::pair<Movers, Movers> movers_between(const DeskMoment& frame, double opens,
                                                       double closes);

/// How an eye's exposure is put together. What stands still is painted once for each 2 px that
/// its near things shift against its far ones, and looked at once for each 2 px that the eye's turn
/// moves it; movers, whose skin has weak texture and soft shading, are painted once for each 4 px
/// that their picture moves within the view. Against steps three to four times as fine, the
/// pictures of blur-hand are off by 0.2 grey levels in the mean (0.1 with 1.5, 1.5 and 3 px), by
/// 0.7 in the worst of ten frames: no more than the noise. At most ten references; fewer than
/// twenty layers and fewer than thirty looks in all, as both are rounded up.
/// @param view  the eye without its lens
[[nodiscard]] Exposure split_exposure(const PinholeCamera& view, const Rigid3& eye_from_camera,
                                      const DeskMoment& frame);

}  // namespace palpable

/// @file
/// How far the pixels of seen things lie from the things' outlines.
///
/// What a camera sees of a round thing ends where its surface turns away: at its outline. The
/// distance from there says how thick the thing is behind a pixel (medial_balls.h). An outline is
/// only where the depth falls off backwards. Where something nearer hides the rest, where the
/// picture ends, and where a few pixels lack their depth, the thing goes on.
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/pixel_box.h"
#include "palpable/live/seen_object/pixel_kernels.h"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace palpable {

struct SilhouetteSettings {
  /// m at 1 m; grows as Z^2 (disparity has constant error). Neighbours whose depths differ by more
  /// belong to different things.
  double largest_jump_at_1m = 0.040;
  /// m: never less, or near the camera a finger's own slope would count as a jump.
  double least_jump = 0.008;
  /// Pixels without depth are looked across, at most so many, to know what lies behind an edge.
  int longest_hole = 12;
  /// px by which outlines are known better than others, and count as so much farther out
  /// (MedialBallSettings::fattening): beside pixels without depth a matcher's windows have not
  /// grown over the room; beside kShowsRoomByColor the picture was asked.
  double beside_unknown = 0, by_color = 0;
};

/// m: what the depths of two neighbouring pixels of one surface differ by at most, at depth z.
[[nodiscard]] float depth_jump(const SilhouetteSettings& settings, float z);

/// A pixel at which two things meet (creases.h), one of them perhaps before the other.
struct CreasePixel {
  std::int16_t x = 0, y = 0;
  Eigen::Vector2f across = Eigen::Vector2f::UnitX();  ///< unit, px, square to the crease
  /// px, of the thing that lies against `across`, and of the one along it: how far it goes on
  /// behind the other one. Nothing: it is wide, or ends nowhere in sight.
  std::array<std::optional<float>, 2> hidden{0.0f, 0.0f};
};

/// Distances of a part of an image. Keeps its memory.
class Silhouette {
 public:
  explicit Silhouette(const SilhouetteSettings& settings = {})
      : settings_(settings),
        jump_{static_cast<float>(settings.least_jump),
              static_cast<float>(settings.largest_jump_at_1m)} {}

  /// @param depth     Z in m, NaN where unknown
  /// @param shows     as ObjectSurface::build (object_surface.h)
  /// @param box       inside the image; a thing that leaves the box goes on beyond it
  /// @param presence  of the image's size, or null: the share of the last frames in which a thing
  ///                  was there. Where it lies between 0 and 1 the outline runs through the pixel
  void find(const DepthImage& depth, const MaskImage& shows, const PixelBox& box,
            const Image<float>* presence = nullptr);

  /// Things end at these pixels, too: `hidden` px beyond them.
  /// @param creases  inside the box, none of them in its last row
  /// @param reach    px: distances are asked for up to here
  void part(std::span<const CreasePixel> creases, int reach);

  /// px, > 0, of pixel (x, y) of the image, from its middle to the outline: two sweeps over the box
  /// that hand on the nearest outline (Danielsson 1980), at most 0.3 px too far. Infinite where
  /// there is no outline; 0 outside of things.
  [[nodiscard]] float distance(int x, int y) const { return distance_[at(x, y)]; }
  /// The distances of a row of the box, its first pixel's first.
  [[nodiscard]] const float* row(int y) const { return distance_.data() + at(box_.x, y); }
  /// Those from pixel (x, y) on, with depths; the row before the box and the one after it are
  /// there, too, without things. Depths are anything where no thing is.
  [[nodiscard]] DistanceRow distances(int x, int y) const {
    const std::size_t n = at(x, y);
    return {&distance_[n], &depths_[n]};
  }
  /// From row to row of these.
  [[nodiscard]] std::size_t stride() const { return stride_; }
  /// From its first thing to its last one, as pixels of the image; empty without any.
  struct Run {
    int begin = 0, end = 0;
  };
  [[nodiscard]] Run things_of_row(int y) const {
    return runs_[static_cast<std::size_t>(y - box_.y)];
  }
  /// Meaningful where the distance is finite and above 0.
  [[nodiscard]] ToOutline to_outline(int x, int y) const { return nearest_[at(x, y)]; }
  /// Whether two neighbouring depths belong to one surface.
  [[nodiscard]] bool joined(float z, float other) const;
  /// m: what they may differ by.
  [[nodiscard]] float jump(float z) const { return depth_jump(settings_, z); }
  [[nodiscard]] const DepthJump& jump() const { return jump_; }
  [[nodiscard]] const PixelBox& box() const { return box_; }
  [[nodiscard]] const SilhouetteSettings& settings() const { return settings_; }

 private:
  [[nodiscard]] std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y - box_.y + 1) * stride_ +
           static_cast<std::size_t>(x - box_.x) + kBefore;
  }
  [[nodiscard]] float known_better(int x, int y) const;
  [[nodiscard]] bool ends_towards(int x, int y, int dx, int dy) const;
  [[nodiscard]] OutlineRow outline_row(int x, int y);
  void begin_row(int y);
  void begin_at(int x, int y);
  void hand_on(const PixelBox& box);
  void bar(int x, int y);
  void begin_beside(const CreasePixel& crease, const Eigen::Vector2f& away, float hidden);

  static constexpr std::size_t kBefore = 1;  // px before each row; beside the box no things are

  SilhouetteSettings settings_;
  DepthJump jump_;
  PixelBox box_;
  const DepthImage* depth_ = nullptr;  // while find() runs, as shows_
  const MaskImage* shows_ = nullptr;
  const Image<float>* presence_ = nullptr;
  // By pixel of the box, with some more in each row, and a row more before and after them.
  std::size_t stride_ = 0;
  std::vector<float> distance_;
  std::vector<ToOutline> nearest_;
  std::vector<float> beyond_;  // px by which that outline lies farther out than between pixels
  std::vector<float> depths_;  // m
  std::vector<Run> runs_;      // by row of the box
};

}  // namespace palpable

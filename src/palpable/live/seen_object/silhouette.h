/// @file
/// The distance of each pixel of a seen thing from the thing's outline.
///
/// The camera sees a curved thing up to its outline, where the surface turns away. The distance of
/// a pixel from the outline tells how thick the thing is behind that pixel (medial_balls.h). A
/// border of the seen region is an outline only if the depth jumps backwards there. Where something
/// nearer hides the rest, at the border of the picture, and at small holes without depth, the thing
/// is taken to continue, and there is no outline.
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
  /// Neighbours whose depths differ by more than max(least_jump, largest_jump_at_1m * Z^2) belong
  /// to different things. Z^2, because disparity has a constant error. In m at Z = 1 m.
  double largest_jump_at_1m = 0.040;
  /// m. Smaller values would take a finger's own slope near the camera for a jump.
  double least_jump = 0.008;
  /// px: the longest run of pixels without depth that is crossed to find what lies behind an edge.
  /// A longer hole counts as an outline.
  int longest_hole = 12;
  /// px by which three kinds of outline are moved outwards, because they are not fattened by the
  /// matcher (MedialBallSettings::fattening): those beside pixels without depth, over which its
  /// windows have not spread, those that were located by colour (kShowsRoomByColor), and those that
  /// were found in the picture (kShowsRoomByEdge).
  double beside_unknown = 0, by_color = 0, by_edge = 0;
};

/// The largest difference in depth of two neighbouring pixels of one surface at depth z, m.
[[nodiscard]] float depth_jump(const SilhouetteSettings& settings, float z);

/// A pixel at which two things meet (creases.h); one of them may lie before the other.
struct CreasePixel {
  std::int16_t x = 0, y = 0;
  Eigen::Vector2f across = Eigen::Vector2f::UnitX();  ///< unit, px, perpendicular to the crease
  /// px by which each thing continues behind the other: first the thing on the side of -across,
  /// then the one on the side of +across. Nothing: it is wide, or its other end is not in sight.
  std::array<std::optional<float>, 2> hidden{0.0f, 0.0f};
};

/// The distances in a part of an image. Keeps its memory.
class Silhouette {
 public:
  explicit Silhouette(const SilhouetteSettings& settings = {})
      : settings_(settings),
        jump_{static_cast<float>(settings.least_jump),
              static_cast<float>(settings.largest_jump_at_1m)} {}

  /// @param depth     Z in m, NaN where unknown
  /// @param shows     as ObjectSurface::build (object_surface.h)
  /// @param box       inside the image; a thing that leaves the box continues beyond it
  /// @param presence  of the image's size, or null: the share of the last frames in which a pixel
  ///                  showed a thing. Where it lies between 0 and 1 the outline runs through the
  ///                  pixel
  void find(const DepthImage& depth, const MaskImage& shows, const PixelBox& box,
            const Image<float>* presence = nullptr);

  /// Adds outlines along creases, the lines at which two things touch in the picture, such as a
  /// fingertip before the palm. Each thing continues behind the other for CreasePixel::hidden px
  /// beyond the crease, and ends there.
  /// @param creases  inside the box, none of them in its last row
  /// @param reach    px: distances are corrected up to this far from the creases
  void part(std::span<const CreasePixel> creases, int reach);

  /// The distance (px, > 0) from the middle of pixel (x, y) of the image to the outline, found by
  /// two sweeps over the box that propagate the nearest point of it (Danielsson 1980). The points
  /// are at most a pixel apart, where the outline passes between two neighbours. At most 0.3 px
  /// too large. Infinite where there is no outline; 0 outside of things.
  [[nodiscard]] float distance(int x, int y) const { return distance_[at(x, y)]; }
  /// The distances of a row of the box, from its first pixel on.
  [[nodiscard]] const float* row(int y) const { return distance_.data() + at(box_.x, y); }
  /// Distances and depths of a row from pixel (x, y) on. The rows before and after the box exist,
  /// too, and hold no things. Depths are undefined where there is no thing.
  [[nodiscard]] DistanceRow distances(int x, int y) const {
    const std::size_t n = at(x, y);
    return {&distance_[n], &depths_[n]};
  }
  /// Elements from one row of distances() to the next.
  [[nodiscard]] std::size_t stride() const { return stride_; }
  /// A range of pixels of a row of the image, begin <= x < end.
  struct Run {
    int begin = 0, end = 0;
  };
  /// The range that holds all things of a row; empty if there are none.
  [[nodiscard]] Run things_of_row(int y) const {
    return runs_[static_cast<std::size_t>(y - box_.y)];
  }
  /// The offset from the middle of the pixel to the nearest point of the outline; undefined where
  /// distance() is infinite or 0.
  [[nodiscard]] ToOutline to_outline(int x, int y) const { return nearest_[at(x, y)]; }
  /// Whether two neighbouring depths belong to one surface.
  [[nodiscard]] bool joined(float z, float other) const;
  /// The largest difference of two such depths at z, m.
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
  [[nodiscard]] bool is_straight(int x, int y, int dx, int dy) const;
  [[nodiscard]] OutlineRow outline_row(int x, int y);
  void begin_row(int y);
  void begin_at(int x, int y);
  void propagate(const PixelBox& box);
  void bar(int x, int y);
  void begin_beside(const CreasePixel& crease, const Eigen::Vector2f& away, float hidden);

  static constexpr std::size_t kBefore = 1;  // px before each row; they hold no things

  SilhouetteSettings settings_;
  DepthJump jump_;
  PixelBox box_;
  // The arguments of find(), while it runs.
  const DepthImage* depth_ = nullptr;
  const MaskImage* shows_ = nullptr;
  const Image<float>* presence_ = nullptr;
  // Per pixel of the box, with kBefore and kReadBeyond more in each row, and one more row before
  // the box and one after it.
  std::size_t stride_ = 0;
  std::vector<float> distance_;
  std::vector<ToOutline> nearest_;
  std::vector<float> beyond_;  // OutlineRow::beyond
  std::vector<float> depths_;  // m
  std::vector<Run> runs_;      // by row of the box
};

}  // namespace palpable

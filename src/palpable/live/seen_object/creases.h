/// @file
/// Creases: lines at which two things touch, side by side or one before the other. The seen surface
/// is concave there, but has no outline. Fingers side by side are separated by creases only.
///
///       beside                      one before the other        Z of a row of pixels,
///      .--.   .--.                  .--.                        the camera looks from above
///     /    \ /    \                /    \                       v: the crease
///    |      v      |              |      v---.
///                                            |
///
/// A crease separates things as an outline does (silhouette.h). Without that, four fingers count as
/// one wide thing, as deep as a palm.
///
/// The farther thing continues behind the nearer one. How far is found from its slope beside the
/// crease, taking its section for a circle of radius r: with v the visible width, from the crease
/// to the outline, and s the sine of the angle at which it slopes at distance a from the crease,
///
///     s = 1 - (a + hidden) / r,   2 r = v + hidden     =>    hidden = (v (1 - s) - 2 a) / (1 + s)
///
///  (B)  all arrays below have one entry per pixel of the silhouette's box, row by row
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/pixel_box.h"
#include "palpable/live/seen_object/silhouette.h"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace palpable {

/// Finds the creases of a depth image. Keeps its memory.
class Creases {
 public:
  /// Finds creases: groups of concave pixels that are curved more than a ball of `most_radius` and
  /// are at least as long as that ball's diameter, because noise makes small concave specks.
  /// Concavity is measured by chords 2/3 of most_radius long. Pixels nearer to an outline than half
  /// a chord are left out.
  /// @param silhouette   of the same depth
  /// @param most_radius  m
  void find(const DepthImage& depth, const PinholeCamera& camera, const Silhouette& silhouette,
            double most_radius);

  /// The result of the last find().
  [[nodiscard]] std::span<const CreasePixel> pixels() const { return pixels_; }
  /// The radius of the largest ball, px, at the nearest crease; 0 if there are no creases.
  [[nodiscard]] int radius_px() const { return radius_px_; }

 private:
  struct Place {
    float sag = 0;               // m: how far the surface lies behind the deepest chord; 0: convex
    std::uint8_t direction = 0;  // of that chord, index of kPixelDirections
    bool gathered = false;       // already in a group
    bool is_middle = false;      // on the crease's middle line
  };
  // The visible part of one of the two things at a crease.
  struct Side {
    int width_px = 0;  // from the crease to where it ends
    double slope = 0;  // m/m, increase of the depth towards the crease
    double along = 0;  // m/m, increase of the depth along the crease
    double at_px = 0;  // from the crease to the middle of the pixels of which the slopes were taken
  };
  void smooth(const DepthImage& depth, const Silhouette& silhouette);
  void measure_sag(int x, int y);
  void gather(std::size_t first);
  [[nodiscard]] Eigen::Vector2f across(int x, int y) const;
  [[nodiscard]] std::optional<int> width_of(const Silhouette& silhouette, int x, int y,
                                            const Eigen::Vector2f& away) const;
  [[nodiscard]] std::optional<Side> side_of(const Silhouette& silhouette, int x, int y,
                                            const Eigen::Vector2f& away) const;
  [[nodiscard]] std::optional<float> hidden_px(const Silhouette& silhouette, int x, int y,
                                               const Eigen::Vector2f& away) const;
  [[nodiscard]] bool has_middle_near(int x, int y) const;
  [[nodiscard]] int px_at(float metres, float inverse_depth) const;
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(box_.width) +
           static_cast<std::size_t>(x);
  }
  [[nodiscard]] bool has(int x, int y) const {
    return x >= 0 && y >= 0 && x < box_.width && y < box_.height;
  }

  // In all private functions, pixels (x, y) are relative to the box's corner.
  PixelBox box_;
  float fx_px_ = 0;
  float radius_ = 0;  // m
  int radius_px_ = 0;
  std::vector<float> inverse_;  // (B) 1/m, of each pixel alone; 0: no thing
  std::vector<float> mean_;     // (B) 1/m, over 3 x 3 px of one surface; 0: no thing
  std::vector<Place> places_;   // (B) reset to Place{} at the end of find()
  std::vector<std::size_t> hollow_, group_;
  std::vector<CreasePixel> pixels_;
};

}  // namespace palpable

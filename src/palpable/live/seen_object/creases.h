/// @file
/// Where two things touch, beside or before each other, what is seen of them is hollow: fingers
/// side by side have no outline between them, but a crease.
///
///       beside                      one before the other        Z of a row of pixels,
///      .--.   .--.                  .--.                        the camera looks from above
///     /    \ /    \                /    \                       v: the crease
///    |      v      |              |      v---.
///                                            |
///
/// A crease parts things as an outline would (silhouette.h). Without that, four fingers count as
/// one wide thing, as deep as a palm.
///
/// The thing behind goes on behind the one before it. How far, its slope beside the crease says, if
/// its section is round: with v the width that is seen of it, from the crease to its outline, and s
/// the sine of the angle at which it falls off to the crease, at the distance a from there,
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

/// Finds them. Keeps its memory.
class Creases {
 public:
  /// A crease is sharper than a ball of `most_radius` and at least as long as that ball is wide:
  /// noise is hollow in specks. How hollow a place is, is asked of chords of 2/3 of most_radius;
  /// nearer to an outline than half of one no crease is looked for.
  /// @param silhouette   of the same depth
  /// @param most_radius  m
  void find(const DepthImage& depth, const PinholeCamera& camera, const Silhouette& silhouette,
            double most_radius);

  /// Those that find() found.
  [[nodiscard]] std::span<const CreasePixel> pixels() const { return pixels_; }
  /// px, of the largest ball at the nearest of them; 0 without any.
  [[nodiscard]] int radius_px() const { return radius_px_; }

 private:
  struct Place {
    float sag = 0;               // m, of the deepest chord; 0: not hollow
    std::uint8_t direction = 0;  // of that chord
    bool gathered = false;
    bool is_middle = false;
  };
  // What is seen of one of the two things at a crease.
  struct Side {
    int width_px = 0;  // from the crease to where it ends
    double slope = 0;  // m/m, towards the crease backwards
    double along = 0;  // the same along the crease
    double at_px = 0;  // from the crease to where the slopes are those
  };
  void smooth(const DepthImage& depth, const Silhouette& silhouette);
  void ask(int x, int y);
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

  // Pixels (x, y) of all functions above count from the box's corner.
  PixelBox box_;
  float fx_px_ = 0;
  float radius_ = 0;  // m
  int radius_px_ = 0;
  std::vector<float> inverse_;  // (B) 1/m, of each pixel alone; 0: no thing
  std::vector<float> mean_;     // (B) 1/m, over 3 x 3 px of one surface; 0: no thing
  std::vector<Place> places_;   // (B) as they were made but while find() runs
  std::vector<std::size_t> hollow_, group_;
  std::vector<CreasePixel> pixels_;
};

}  // namespace palpable

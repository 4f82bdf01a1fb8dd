/// @file
/// Small patches of pictures: cut where a point was first seen, and found again in later pictures.
///
///     PatchSource --warp(), with the predicted smear--> PatchTemplate --follow()--> position
///
/// follow() makes Gauss-Newton steps with the gradients of the template, which are computed once
/// (Baker and Matthews, "Lucas-Kanade 20 years on", 2004: inverse compositional). Mean and contrast
/// of template and picture are normalised, so that exposure and light do not matter.
#pragma once

#include "palpable/common/geometry/image.h"

#include <Eigen/Core>

#include <array>
#include <cstdint>

namespace palpable {

/// An image and its halves: level l has 2^-l of its width and height.
class Pyramid {
 public:
  static constexpr int kLevels = 4;

  /// @param full  is not copied: it must outlive all uses of level 0
  void build(const GrayImage& full);

  [[nodiscard]] const GrayImage& level(int l) const { return l == 0 ? *full_ : halves_[l - 1]; }

  /// Converts pixels of level 0 to pixels of level l and back. A pixel of level l is the centre of
  /// 2^l x 2^l pixels of level 0.
  [[nodiscard]] static Eigen::Vector2d to_level(const Eigen::Vector2d& uv, int l) {
    const double s = 1 << l;
    return (uv.array() + 0.5) / s - 0.5;
  }
  [[nodiscard]] static Eigen::Vector2d from_level(const Eigen::Vector2d& uv, int l) {
    const double s = 1 << l;
    return (uv.array() + 0.5) * s - 0.5;
  }

 private:
  const GrayImage* full_ = nullptr;
  std::array<GrayImage, kLevels - 1> halves_;
};

/// The surroundings of one pixel at every level, as they looked in one image.
struct PatchSource {
  static constexpr int kSide = 28;

  struct Level {
    bool usable = false;   ///< false: the point is too close to the border to be compared
    float cx = 0, cy = 0;  ///< the point in px of this level, relative to the patch's first pixel
    std::array<std::uint8_t, kSide * kSide> pixels{};
  };
  std::array<Level, Pyramid::kLevels> levels;

  /// @param uv  px of level 0
  static PatchSource cut(const Pyramid& image, const Eigen::Vector2d& uv);
};

/// A window as it should look in the searched image: mean 0, standard deviation 1.
struct PatchTemplate {
  static constexpr int kSide = 12;  ///< offsets -6 .. 5 from the point
  static constexpr int kReach = 6;
  static constexpr int kPixels = kSide * kSide;

  std::array<float, kPixels> value{};
  std::array<float, kPixels> gx{};
  std::array<float, kPixels> gy{};
  float h_xx = 0, h_xy = 0, h_yy = 0;  ///< inverse of sum g g^T
  float contrast = 0;                  ///< grey levels: standard deviation before normalisation

  /// Makes the template from a source.
  /// @param level  of the image that will be searched
  /// @param image_from_source  (2 x 2) px of the searched image per px of the source, at level 0
  /// @param smear  px of `level`: motion of the image while the shutter is open
  /// @return false if the source has no level of fitting size, or too little texture to be followed
  ///         in x and in y
  [[nodiscard]] bool warp(const PatchSource& source, int level,
                          const Eigen::Matrix2d& image_from_source, const Eigen::Vector2d& smear);

  /// Makes the template from the window around (x, y) of an image, to be followed along its row.
  /// @return false outside of the image, or without texture along x
  [[nodiscard]] bool cut(const GrayImage& image, double x, double y);
};

struct PatchSearch {
  int steps = 8;           ///< largest number of Gauss-Newton steps
  bool along_row = false;  ///< true: y is not changed
  double farthest = 6;     ///< px of that level from the start in x or y; beyond, it is not found
};

struct PatchMatch {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();  ///< px of the searched level
  double likeness = 0;                           ///< normalised cross correlation there, -1..1
  bool found = false;  ///< it converged, inside of the image and not too far from the start
};

/// Follows a template from `start` (px of `image`).
[[nodiscard]] PatchMatch follow(const GrayImage& image, const PatchTemplate& patch,
                                const Eigen::Vector2d& start, const PatchSearch& search = {});

/// Normalised cross correlation of a template with an image at one position; -1 outside of it.
[[nodiscard]] double likeness_at(const GrayImage& image, const PatchTemplate& patch,
                                 const Eigen::Vector2d& at);

}  // namespace palpable

/// @file
/// Small patches of images: kept from where a point was first seen, and found again.
///
/// A patch is followed by Gauss-Newton steps on the template, its gradients taken once (Baker and
/// Matthews, "Lucas-Kanade 20 years on", 2004: inverse compositional), warped and smeared by what
/// the motion of the camera predicts, brightness and contrast of both sides divided out.
#pragma once

#include "palpable/geometry/image.h"

#include <Eigen/Core>

#include <array>
#include <cstdint>

namespace palpable {

/// An image and its halves: level l is 2^-l as large.
class Pyramid {
 public:
  static constexpr int kLevels = 4;

  /// @param full  kept by address; has to live as long as this is read
  void build(const GrayImage& full);

  [[nodiscard]] const GrayImage& level(int l) const {
    return l == 0 ? *full_ : halves_[static_cast<std::size_t>(l - 1)];
  }

  /// Pixel of level 0 as pixel of level l: centres of blocks.
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
    bool usable = false;   ///< false: too near the border to be compared
    float cx = 0, cy = 0;  ///< the point in this level's pixels, from the patch's first one
    std::array<std::uint8_t, kSide * kSide> pixels{};
  };
  std::array<Level, Pyramid::kLevels> levels;

  /// @param uv  px of level 0
  static PatchSource cut(const Pyramid& image, const Eigen::Vector2d& uv);
};

/// A window as it should look in the image that is searched: mean 0, standard deviation 1.
struct PatchTemplate {
  static constexpr int kSide = 12;  ///< offsets -6 .. 5 from the point
  static constexpr int kReach = 6;
  static constexpr int kPixels = kSide * kSide;

  std::array<float, kPixels> value{};
  std::array<float, kPixels> gx{};
  std::array<float, kPixels> gy{};
  float h_xx = 0, h_xy = 0, h_yy = 0;  ///< inverse of sum g g^T
  float contrast = 0;  ///< grey levels, standard deviation before it was divided out

  /// @param level  of the image that will be searched
  /// @param image_from_source  (2 x 2) px of the searched image per px of the source, at level 0
  /// @param smear  px of `level`: how far the image moves while the shutter is open
  /// False where the source has no fitting level or nothing that could be followed in x and y.
  [[nodiscard]] bool warp(const PatchSource& source, int level,
                          const Eigen::Matrix2d& image_from_source, const Eigen::Vector2d& smear);

  /// The window around (x, y) of an image, unwarped; false outside or without texture along x.
  [[nodiscard]] bool take(const GrayImage& image, double x, double y);
};

struct PatchSearch {
  int steps = 8;
  bool along_row = false;  ///< y stays
  double farthest = 6;     ///< px of that level; a patch that wanders farther is not found
};

struct PatchMatch {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();  ///< px of the searched level
  double likeness = 0;                           ///< normalised cross correlation there, -1..1
  bool found = false;  ///< converged inside the image and not too far from the start
};

/// Follows a template from `start` (px of `image`).
[[nodiscard]] PatchMatch follow(const GrayImage& image, const PatchTemplate& patch,
                                const Eigen::Vector2d& start, const PatchSearch& search = {});

/// Normalised cross correlation of a template with an image at one place; -1 outside.
[[nodiscard]] double likeness_at(const GrayImage& image, const PatchTemplate& patch,
                                 const Eigen::Vector2d& at);

}  // namespace palpable

/// @file
/// Outlines of real things that hide the body, at the picture's resolution.
///
/// A stereo matcher at half the resolution widens near things by up to six of its pixels towards
/// the left, where only the left eye sees the background, and closes narrow gaps between near
/// things. Colours do not have these errors. So beside a jump of the depth, the colour of each
/// pixel decides on which side of the jump it lies.
///
///   w, h  size of the depth image, half that of the picture
#pragma once

#include "palpable/geometry/image.h"
#include "palpable/render/fill_unknown.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace palpable {

/// Corrects on which side of a jump of the depth the pixels beside it lie.
///
/// **Pixels in doubt.** For a pixel, let F be any pixel whose depth is a guess, or larger than its
/// own by more than the share kJump. In doubt are the pixels up to kDoubtLeft px right of an F, up
/// to kDoubtRight px left of one, and up to kDoubtAcross px above or below one; pixels with a
/// neighbour that is nearer by more than kJump; and guesses. All others are sure.
///
/// **Decision** for a pixel p in doubt with colour c_p. The votes are those of sure pixels q on a
/// lattice with a step of kLatticeStep px, within kWindow px of p. The harmonic mean of their least
/// and largest depth separates the near ones (n) from the far ones (f):
///
///     P_k(p) = sum_{q in k} s(p, q) g(c_p - c_q)  /  sum_{q in k} s(p, q),     k = n, f
///     s = max(0, 1 - |p - q|^2 / R_s^2)^2,   g = max(0, 1 - |c_p - c_q|^2 / R_c^2)^2
///
/// P_k measures how well the colour fits side k, whatever the number of pixels on that side. (The
/// weights are those of adaptive support, Yoon and Kweon 2006, applied to labels instead of costs.)
/// The side with the larger P wins. If p lay on the other side it gets the mean depth of the
/// winner's pixels. If the window shows no jump, p keeps its depth. A 3 x 3 median smooths the
/// decisions.
///
/// **Full resolution.** A pixel of the depth image beside a jump covers four pixels of the picture.
/// Each of these goes to the side whose mean colour, within 2 px of the depth image, is more like
/// its own.
class RealOutlines {
 public:
  /// A change of depth from one pixel to the next is a jump above this share of the depth. A desk
  /// seen at 80 degrees changes by 1.6 %.
  static constexpr float kJump = 0.06f;
  static constexpr int kDoubtLeft = 5;    ///< px; the matcher widens near things by 3-6 px
  static constexpr int kDoubtRight = 3;   ///< px
  static constexpr int kDoubtAcross = 3;  ///< px
  static constexpr int kLatticeStep = 4;  ///< px
  static constexpr int kWindow = 28;  ///< px: behind a half-seen strip of 25 px lies its background
  /// px by which `box` should exceed `inner` on each side, so that windows lie within it.
  static constexpr int kMargin = kWindow + kLatticeStep;

  /// @param picture  colours, twice as wide and high as the depth image, or one pixel more
  /// @param box      the part of the depth image that `depth` holds, in its pixels
  /// @param depth    (h x w) row-major, m, as fill_unknown() leaves it
  /// @param guessed  (h x w) nearest_in_row of fill_unknown(): not 0 where `depth` is a neighbour's
  /// @param inner    the pixels to correct, within `box`
  /// Allocates nothing once it has seen a box of this size.
  /// @throws ContractViolation when sizes do not match
  void find(const ColorImage& picture, const PixelRange& box, std::span<const float> depth,
            std::span<const signed char> guessed, const PixelRange& inner);

  /// (2 inner.h x 2 inner.w) of the last find(), m; 0 unknown. Row y, column x is the picture's
  /// pixel (2 inner.x0 + x, 2 inner.y0 + y).
  [[nodiscard]] std::span<const float> depth() const { return fine_; }

 private:
  struct Color {
    float r, g, b;
  };
  // The lattice's pixels, row by row, one array for each quantity; `sure` is 1 or 0.
  struct Lattice {
    int width = 0;  // including empty columns at the end, which a window may read
    int height = 0;
    std::vector<float> sure, r, g, b, inverse;  // inverse: 1/m
  };
  // How well a colour fits the two sides of a window, and their mean depths in m. `parted`: the
  // window shows both sides of a jump.
  struct Verdict {
    bool parted = false;
    float split = 0;  // 1/m
    float near_fit = 0, far_fit = 0;
    float near_depth = 0, far_depth = 0;
  };

  [[nodiscard]] std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(w_) + static_cast<std::size_t>(x);
  }
  void average_colors(const ColorImage& picture, const PixelRange& box);
  void find_doubts(std::span<const signed char> guessed);
  void build_lattice();
  [[nodiscard]] Verdict of_window(int x, int y) const;
  void decide(const PixelRange& inner);
  void smooth(const PixelRange& inner);
  void write_fine(const ColorImage& picture, const PixelRange& box, const PixelRange& inner);

  int w_ = 0;
  int h_ = 0;
  std::vector<float> z_, decided_, fine_;  // m
  std::vector<Color> color_;
  std::vector<std::uint8_t> doubt_;  // 0 or 1
  Lattice lattice_;
};

}  // namespace palpable

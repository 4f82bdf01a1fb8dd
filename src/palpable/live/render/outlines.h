/// @file
/// Finds where real things hide the body, at the picture's resolution.
///
/// A stereo matcher at half the resolution widens near things by up to six of its pixels towards
/// the left, where only the left eye sees the background; it closes narrow gaps between near
/// things, and gives no depth for things nearer than its range. Colours and the moving mask do not
/// have these errors. Where the depth is in doubt, they give the likelihood that something real is
/// nearer than the body, and the minimum cut of a graph over the body's rectangle classifies all
/// pixels together. Since no pixel is classified alone, there are no specks.
///
///   w, h  size of the depth image, half that of the picture
#pragma once

#include "palpable/common/geometry/image.h"
#include "palpable/live/render/fill_unknown.h"
#include "palpable/live/render/grid_cut.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace palpable {

/// Input of RealOutlines::find(). Read during find() only.
struct OutlineView {
  const ColorImage& picture;     ///< twice as wide and high as the depth image, or one pixel more
  PixelBox box;                  ///< the part of the depth image that `depth` holds, in its pixels
  std::span<const float> depth;  ///< (h x w) row-major, m, as fill_unknown() leaves it
  /// (h x w) nearest_in_row of fill_unknown(): not 0 where `depth` is a neighbour's.
  std::span<const signed char> guessed;
  PixelBox inner;               ///< the part that may show the body, within `box`
  std::span<const float> body;  ///< (2 inner.h x 2 inner.w) Z of the body, m; 0 beside it
  /// Of the depth image's size, or null: 255 where something moves (Scene::moving) ...
  const MaskImage* moving = nullptr;
  /// ... and where something is nearer than the depth's range (SeenFrame::too_close).
  const MaskImage* too_close = nullptr;
};

/// Finds whether real surfaces lie before or behind the body.
///
/// **Pixels in doubt.** For a pixel, let F be any pixel whose depth is a guess, or larger than its
/// own by more than the share kJump. In doubt are the pixels up to kDoubtLeft px right of an F, up
/// to kDoubtRight px left of one, and up to kDoubtAcross px above or below one; pixels with a
/// neighbour that is nearer by more than kJump; and guesses. All others are sure: their depth
/// determines whether they are before the body (n, nearer than it by 1.5 occlusion_bias()) or not
/// (f).
///
/// **Votes** for a pixel p in doubt with colour c_p come from sure pixels q on a lattice with a
/// step of kLatticeStep px, within kWindow px of p. Pixels marked too close are sure, and are n.
///
///     P_k(p) = sum_{q in k} s(p, q) g(c_p - c_q)  /  sum_{q in k} s(p, q),     k = n, f
///     s = max(0, 1 - |p - q|^2 / R_s^2)^2,   g = max(0, 1 - |c_p - c_q|^2 / R_c^2)^2
///
/// Shade changes brightness Y = 0.3 R + 0.6 G + 0.1 B more than hue, so a colour is
///
///     c = (Y / 2,  400 (R - B) / (Y + 32),  400 (R + B - 2 G) / (Y + 32))        R, G, B in 0..255
///
/// P_k measures how well the colour fits side k, independently of the number of pixels on that
/// side. (The weights are those of adaptive support, Yoon and Kweon 2006, applied to labels instead
/// of costs.) Likewise M_k is the share of moving pixels on side k; without votes, M_n is 1 and M_f
/// is 0. With m_p whether p moves,
///
///     bias(p) = log P_n / P_f + log P(m_p | M_n) / P(m_p | M_f) + a small term from p's own depth
///
/// So a moving pixel without depth is before the body if no moving pixel around it has a depth: it
/// is too close to be measured, and in front of everything. If the bias of a pixel contradicts the
/// depth of a sure neighbour, a bias is computed for the neighbour, too, and from there on for its
/// neighbours, as long as the biases contradict their depths.
///
/// **Cut.** grid_cut.h divides these pixels into two sides by their biases and by links between
/// neighbours, which are weaker the more the neighbours' colours differ; sure neighbours keep their
/// side. A pixel that changes sides gets the mean depth of the votes of its new side; without
/// votes, kTooClose before the body and 0 (unknown) behind it.
///
/// **Full resolution.** A pixel of the depth image beside a border covers four pixels of the
/// picture. Each of these goes to the side whose mean colour, within 2 px of the depth image, is
/// more like its own.
class RealOutlines {
 public:
  /// The largest change of depth from one pixel to the next within a surface, as a ratio to the
  /// depth. That of a desk seen at 80 degrees is 1.6 %.
  static constexpr float kJump = 0.06f;
  static constexpr int kDoubtLeft = 5;    ///< px; the matcher widens near things by 3-6 px
  static constexpr int kDoubtRight = 3;   ///< px
  static constexpr int kDoubtAcross = 3;  ///< px
  static constexpr int kLatticeStep = 4;  ///< px
  static constexpr int kWindow = 28;      ///< px; reaches across a half-seen strip of 25 px
  /// px by which `box` should exceed `inner` on each side, so that windows lie within it.
  static constexpr int kMargin = kWindow + kLatticeStep;
  /// m, written where something is nearer than the depth's range.
  static constexpr float kTooClose = 0.05f;

  /// Allocates nothing once it has seen a box of this size.
  /// @throws ContractViolation when sizes do not match
  void find(const OutlineView& view);

  /// (2 inner.h x 2 inner.w) of the last find(), m; 0 unknown. Row y, column x is the picture's
  /// pixel (2 inner.x + x, 2 inner.y + y).
  [[nodiscard]] std::span<const float> depth() const { return fine_; }

 private:
  // A colour as its brightness and two differences of its channels as ratios to the brightness:
  // `warm` is red - blue, `pink` is red + blue - 2 green. Each is weighted so that equal distances
  // matter equally.
  struct Color {
    float light, warm, pink;
  };
  // The lattice's pixels, row by row, one array for each quantity; `sure` is 1 or 0.
  struct Lattice {
    int width = 0;  // including empty columns at the end, which a window may read
    int height = 0;
    std::vector<float> sure, light, warm, pink, inverse, moving;  // inverse: 1/m
  };
  // The bias of a pixel, and the mean depths (m) of the votes of both sides; 0 for a side without
  // votes.
  struct Verdict {
    float bias = 0;  // above 0: before the body
    float near_depth = 0, far_depth = 0;
  };

  [[nodiscard]] std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(w_) + static_cast<std::size_t>(x);
  }
  [[nodiscard]] static std::size_t index(const PixelBox& box, int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(box.width) +
           static_cast<std::size_t>(x);
  }
  [[nodiscard]] static Color color_of(float red, float green, float blue);
  void average_colors(const OutlineView& view);
  void read_masks(const OutlineView& view);
  void find_body(const OutlineView& view, const PixelBox& own, const PixelBox& voting);
  void find_doubts(const OutlineView& view);
  void build_lattice();
  [[nodiscard]] Verdict of_window(int x, int y, float limit, signed char guess) const;
  // The cut's steps, on the pixels of the box `voting`, from whose corner x and y count.
  void decide(const OutlineView& view, const PixelBox& voting);
  void find_voters(const OutlineView& view, const PixelBox& voting);
  void link_pixels(const PixelBox& voting);
  // Whether the cut classifies a pixel; if not, whether a sure real surface there is before the
  // body.
  enum class Role : std::uint8_t { kNone, kVoter, kBefore, kBehind };
  [[nodiscard]] Role role(const PixelBox& voting, int x, int y) const {
    const float limit = limit_[index(voting, x, y)];
    const std::size_t i = at(voting.x + x, voting.y + y);
    if (!(limit > 0.0f)) return Role::kNone;
    if (doubt_[i] != 0) return Role::kVoter;
    return z_[i] < limit ? Role::kBefore : Role::kBehind;
  }
  void write_fine(const OutlineView& view, const PixelBox& inner);

  int w_ = 0;
  int h_ = 0;
  bool knows_moving_ = false;
  std::vector<float> scratch_;
  std::vector<float> z_, limit_, fine_;  // m; limit_: what is nearer is before the body, 0 no body
  std::vector<Color> color_;
  static constexpr std::uint8_t kDoubted = 2;  // sure by itself, but a neighbour's bias contradicts
  std::vector<std::uint8_t> doubt_;            // 0: sure, 1: in doubt, or kDoubted
  std::vector<std::uint8_t> moving_, close_;   // 0 or 1
  Lattice lattice_;
  GridCut cut_;
  std::vector<Verdict> verdicts_;
  std::vector<int> growing_;
};

}  // namespace palpable

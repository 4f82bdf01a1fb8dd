/// @file
/// A picture of the static scene: how each pixel looks while nothing moves there. Comparing a frame
/// with it finds a hand where depth cannot: closer than the matcher's range, and beside the hand's
/// outline, where the matcher assigns the hand's depth to the background.
///
/// It is for a camera that stands still. After a motion it must be learnt anew (forget()). For a
/// camera that sways, a view of the scene that is drawn for each frame replaces the picture
/// (scene_canvas.h).
///
///   tile  a square of 4 x 4 pixels of the depth image
///   Y, P  luma of this frame and of the picture, 0 .. 255, at the depth image's size
#pragma once

#include "palpable/common/geometry/image.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace palpable {

/// The colour of a tile: sums over eight of its pixels.
struct TileColor {
  std::uint16_t r = 0, g = 0, b = 0;
};

/// The static scene as it should look from the camera's present pose (scene_canvas.h).
struct PictureView {
  GrayImage luma;                   ///< of the depth image's size
  Image<TileColor> colors;          ///< per tile
  Image<std::uint8_t> known;        ///< per tile: not 0 where luma and colour are known
  Image<std::uint8_t> needs_color;  ///< per tile: not 0 where the canvas needs the frame's colour
};

inline constexpr int kTile = 4;  ///< px of the depth image, a tile's side

struct StaticPictureSettings {
  /// Frames in which a tile must look the same before it is known, 1 .. 50. With too few, something
  /// that a hand uncovers only for a moment is taken for the scene.
  int frames_to_trust = 6;
  /// Frames after which a tile that has changed although its depth is the scene's is learnt anew: a
  /// page was turned or a lamp moved. This excludes tiles in shadow, because the shadow leaves with
  /// the hand.
  int frames_to_renew = 24;
  /// Frames after which any other changed tile is learnt anew: a thing that stays there has become
  /// part of the scene (20 s at 30 frames per second).
  int frames_to_settle = 600;
};

/// Decides for tiles and pixels whether they look like the static scene.
///
/// **Exposure.** Light and camera change all pixels by a gain g: the median of Y / P over the tiles
/// whose depth is the scene's. The remaining difference is D = |Y - g P|.
///
/// **Noise.** Its magnitude m is measured in each frame: each static tile has a mean of D, and m is
/// the median of these means. For normal noise of standard deviation s, m = 0.8 s. The mean of n
/// independent values of D has the standard deviation 0.6 s / sqrt(n). Rectification correlates the
/// noise of neighbouring pixels, which raises it by a factor of sqrt(2), to 1.06 m / sqrt(n). The
/// bound for the mean of D at k standard deviations is
///
///     a_k(n) = m (1 + 1.06 k / sqrt(n)) + 1/2
///
/// where 1/2 accounts for the rounding to whole grey levels.
///
/// **Look** of a tile (n = 16):
///
///     same      mean D <= a_4 + P / 64
///     changed   mean D > a_8 + P / 32
///     nothing   between these bounds, or while the tile is not known
///
/// The shares of P allow for light that a hand reflects onto the scene, or that it blocks without
/// casting a distinct shadow.
///
/// **Squares.** In the dark the noise of one tile hides a hand whose grey level is near the
/// scene's. So hue is compared over a square of 1, 3 x 3 or 5 x 5 tiles: the smallest in which the
/// noise changes the hue by less than 1/32, or otherwise the largest. A tile of the square counts
/// only if its Y / P equals that of the middle tile within the noise, so that the sum does not
/// extend across an edge.
///
/// **Shadow.** A changed tile looks shaded if it is darker, but not below L = Y / (g P) = 0.4, and
/// has the scene's hue. The hue of a shadow differs a little. Let the sun contribute the shares
/// S_r, S_g, S_b of the red, green and blue light, and the sky the rest. A point that has lost the
/// part t of the sun keeps 1 - t S of its light, and its ratio of blue to green changes by
///
///     (1 - t S_b) / (1 - t S_g) - 1  =  (1 - S_b / S_g) (1 - L) / L      (L of green)
///
/// So the hue may differ by h = min(0.14 (1 - L) / L, 0.11) plus one standard deviation of the
/// square's noise. On the test ground 1 - S_b / S_g is 0.10 to 0.115, and L = 0.55 to 0.62 in full
/// shade; the hues of skin, sleeve and wood differ by more than 10 %.
///
/// **Chance.** Somewhere on a shaded hand the grey level equals that of the desk, and a highlight
/// on it may be as bright as white paper, so some of the hand's tiles look the same by chance.
/// Therefore each neighbour of a changed tile whose look is "same" or "nothing" is tested again,
/// over its square:
///
///     changed   the hue differs by more than h + 1/32 plus two standard deviations
///     nothing   (only for squares of 3 x 3 and more, where one tile alone is too noisy)
///               the hue differs by more than h + 1/64 plus one standard deviation; the tile's
///               depth then decides
///
/// The neighbours of a tile that becomes "changed" or "nothing" are tested in turn. Tiles whose
/// depth is the scene's are not tested.
///
/// **Learning.** P takes over an unknown tile at once. The tile is known after frames_to_trust
/// frames in which its look does not change, or five times as many if the mask marks it as moving.
/// From then on P follows Y by at most one level in every fourth frame, so that it converges to the
/// median of Y (Manzanera and Richefeu 2007).
class StaticPicture {
 public:
  /// kNothing: undecided.
  enum Look : std::uint8_t { kNothing, kSame, kShadow, kChanged };

  /// @throws ContractViolation for settings out of their range
  explicit StaticPicture(const StaticPictureSettings& settings = {});

  /// Compares a frame with the picture. Allocates at the first frame of a size.
  /// @param luma       as large as the depth image, or twice as large
  /// @param color      as large as the depth image, or twice as large
  /// @param width      of the depth image, px
  /// @param height     of the depth image, px
  /// @param is_static  per tile: not 0 where its depth is the static scene's
  /// @return false if the images have other sizes; then nothing was compared
  bool compare(const GrayImage& luma, const ColorImage& color, int width, int height,
               const Image<std::uint8_t>& is_static);

  /// Compares a frame with a view that was drawn for it, for a camera that sways. A view may be
  /// displaced by a pixel, because of its rounding, the error of the pose, or a rolling shutter. So
  /// a pixel is compared with the range of the view over the 3 x 3 pixels around it: P is the value
  /// in that range that is nearest to Y.
  bool compare(const GrayImage& luma, const ColorImage& color, int width, int height,
               const Image<std::uint8_t>& is_static, const PictureView& view);

  /// Allocates for a size in advance, which the first compare() would do otherwise.
  void resize(int width, int height, const Image<std::uint8_t>& tiles);

  /// The last frame's luma, at the depth's size.
  [[nodiscard]] const GrayImage& luma() const { return now_; }
  /// The last frame's colour of a tile; null where it was not computed. It is computed for tiles
  /// that are not known, or, with a view, for static tiles with PictureView::needs_color.
  [[nodiscard]] const TileColor* color(int i, int j) const {
    return colored_(i, j) != 0 ? &colors_now_(i, j) : nullptr;
  }

  /// How a tile looks, by the last compare().
  [[nodiscard]] Look tile(int i, int j) const { return static_cast<Look>(look_(i, j)); }
  /// Whether a pixel and its eight neighbours look the same, by a_4 with n = 9. False at the
  /// image's border, and in a tile that is not known.
  [[nodiscard]] bool is_same_pixel(int x, int y) const;
  /// Whether noise is low enough to distinguish single pixels of the tile from the scene: the bound
  /// that the noise sets is at most P / 16. Otherwise a pixel may look the same by chance.
  [[nodiscard]] bool distinguishes_pixels(int i, int j) const;
  /// Whether a tile shows nothing but noise. The matcher finds no texture there, so its depth for
  /// the tile is copied from neighbours.
  [[nodiscard]] bool is_plain(int i, int j) const;
  /// Whether a tile and most of its neighbours look as the scene has looked since the picture was
  /// begun; plain tiles may be in shadow. A look that was learnt again later, or while something
  /// moved there, may be that of a new object and does not count as the scene's.
  [[nodiscard]] bool looks_as_ever(int i, int j) const;
  /// Whether this is one of the first frames, in which motion cannot be recognised yet.
  [[nodiscard]] bool starting() const { return frame_ < 2 * settings_.frames_to_trust; }

  /// Updates the picture from the frame of the last compare().
  /// @param moves      per tile: not 0 where it or a neighbour moves
  /// @param is_static  as for compare()
  void learn(const Image<std::uint8_t>& moves, const Image<std::uint8_t>& is_static);

  /// Forgets all looks: the camera has moved in this frame.
  void forget();

 private:
  // Sums over those tiles of a square whose brightness has changed by the same ratio as that of
  // the middle tile.
  struct Square {
    bool alone = false;                            // the square is a single tile
    int tiles = 0;                                 // number of tiles that were summed
    int now = 0, expected = 0;                     // sums of Y and g P
    std::array<int, 3> color_now{}, color_then{};  // r g b, of the frame and of the picture
  };

  bool halve(const GrayImage& luma, const ColorImage& color, int width, int height,
             const Image<std::uint8_t>& tiles);
  void use_view(const PictureView& view);
  void replace_by_nearest(const PictureView& view);
  void find_gain(const Image<std::uint8_t>& is_static);
  void find_differences();
  void find_noise(const Image<std::uint8_t>& is_static);
  void decide_looks(const ColorImage& color, const Image<std::uint8_t>& is_static,
                    const PictureView* view);
  void find_looks(const ColorImage& color, const Image<std::uint8_t>& is_static,
                  const PictureView* view);
  void spread_changes(const ColorImage& color, const Image<std::uint8_t>& is_static);
  void test_for_chance(const ColorImage& color, const Image<std::uint8_t>& is_static, int i, int j);
  void compute_color(const ColorImage& color, int i, int j);
  [[nodiscard]] TileColor color_of(const ColorImage& color, int i, int j) const;
  // The sum of g P over a tile.
  [[nodiscard]] int expected(int i, int j) const { return sum_then_(i, j) * gain_ / kUnit; }
  [[nodiscard]] double color_noise() const;
  [[nodiscard]] Square square_of(const ColorImage& color, int i, int j);
  [[nodiscard]] bool has_hue_of_scene(const Square& square, double bounds, double light) const;
  bool learn_tile(int i, int j, bool is_quiet, bool is_static);
  void take_over(int i, int j);
  [[nodiscard]] bool is_as_ever(int i, int j) const;
  void follow_row(int j);

  static constexpr int kUnit = 512;  // a gain of 1 in fixed-point units

  StaticPictureSettings settings_;
  int trust_;                             // value of sure_ at which a tile is known
  int factor_ = 1;                        // the colour image's size over the picture's
  int tiles_ = 0, rows_ = 0;              // whole tiles across, and rows of them
  GrayImage now_, picture_, difference_;  // Y, P and D
  GrayImage least_, largest_;             // of three rows of a view, over three pixels of each
  Image<std::uint16_t> sum_now_, sum_then_, sum_difference_;  // of Y, P and D, per tile
  Image<TileColor> colors_, colors_now_;                      // of the picture and of the frame
  Image<std::uint8_t> colored_;   // per tile: not 0: colors_now_ is this frame's
  Image<std::uint8_t> look_;      // per tile
  Image<std::uint8_t> tested_;    // per tile: not 0: tested for chance in this frame
  std::vector<int> queue_;        // tiles whose neighbours are to be tested
  Image<std::uint8_t> sure_;      // per tile: from 0 (nothing is known) to trust_ (known)
  Image<std::uint8_t> anew_;      // per tile: not 0: it may show a new object (looks_as_ever())
  Image<std::uint16_t> strange_;  // per tile: successive frames in which it was changed
  std::vector<std::uint16_t> columns_, columns_of_difference_;  // sums over four rows of pixels
  std::vector<std::uint8_t> scaled_;                            // a row of pixels times a gain
  std::vector<std::uint8_t> follows_;  // a row of pixels: 255 where P follows Y, else 0
  std::vector<int> histogram_;
  int gain_;               // g of the picture, in units of 1 / kUnit
  int view_gain_ = kUnit;  // g of the last view, in units of 1 / kUnit
  double noise_ = -1;      // m, grey levels; < 0: not measured yet
  int frame_ = 0;          // frames so far
  // Bounds of the sum of D: over a pixel and its eight neighbours, and over a tile. The initial
  // values, valid until the noise is measured, make no pixel the same.
  int same_pixel_ = -1, changed_tile_ = 16 * 8;
};

}  // namespace palpable

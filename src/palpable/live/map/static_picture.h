/// @file
/// A picture of the static scene: how each pixel looks while nothing moves there. Comparing a frame
/// with it finds a hand where depth cannot: where it is nearer than the matcher's range, and beside
/// its outline, where the matcher gives the background the hand's depth.
///
/// It is for a camera that stands. After a motion it must be learnt anew (forget()). For a camera
/// that sways a view of the scene is drawn for each frame, and takes the picture's place
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

/// Sums of a tile's colour over eight of its pixels.
struct TileColor {
  std::uint16_t r = 0, g = 0, b = 0;
};

/// The static scene as a frame should show it from where its camera is (scene_canvas.h).
struct PictureView {
  GrayImage luma;             ///< of the depth image's size
  Image<TileColor> colors;    ///< per tile
  Image<std::uint8_t> known;  ///< per tile: not 0 where luma and colour are known
  Image<std::uint8_t> asks;   ///< per tile: not 0 where the canvas wants the frame's colour
};

inline constexpr int kTile = 4;  ///< px of the depth image, a tile's side

struct StaticPictureSettings {
  /// Frames in which a tile must look the same before it is known, 1 .. 50. Fewer, and what a hand
  /// uncovers for a moment would be the scene's look.
  int frames_to_trust = 6;
  /// Frames after which a tile whose depth is the scene's, but which has changed, is learnt anew:
  /// a page was turned, a lamp moved. A tile in shadow is not: its shadow goes with the hand.
  int frames_to_renew = 24;
  /// Frames after which any other changed tile is learnt anew: what stays there is part of the
  /// scene (20 s at 30 frames per second).
  int frames_to_settle = 600;
};

/// Decides for tiles and pixels whether they look as the static scene does.
///
/// **Exposure.** Light and camera change all pixels by a gain g: the median of Y / P over the tiles
/// whose depth is the scene's. What is left is D = |Y - g P|.
///
/// **Noise.** Its size m is measured in each frame: the median over the same tiles of the mean of
/// D. For normal noise of standard deviation s, m = 0.8 s. The mean of n values of D scatters by
/// 0.6 s / sqrt(n), and by sqrt(2) more, since rectification makes neighbours' noise alike. In
/// units of m that is 1.06 / sqrt(n). The bound for k standard deviations is
///
///     a_k(n) = m (1 + 1.06 k / sqrt(n)) + 1/2      of the mean of D
///
/// where 1/2 stands for the rounding to whole grey levels.
///
/// **Look** of a tile (n = 16):
///
///     same      mean D <= a_4 + P / 64
///     changed   mean D > a_8 + P / 32
///     nothing   between these bounds, or while the tile is not known
///
/// The shares of P allow for light that a hand reflects onto the scene, or takes from it without
/// casting a shadow.
///
/// **Squares.** In the dark the noise of one tile hides a hand whose level is near the scene's. So
/// hue is compared over a square of 1, 3 x 3 or 5 x 5 tiles: the smallest in which the noise
/// changes it by less than 1/32, or else the largest. Of the square only those tiles count whose Y
/// / P is that of the middle one within the noise, so that it does not reach across an edge.
///
/// **Shadow.** A changed tile looks shaded if it is darker, but not below L = Y / (g P) = 0.4, and
/// has the scene's hue. The hue of a shadow differs a little. Let the sun give the shares S_r, S_g,
/// S_b of the red, green and blue light, and the sky the rest. A place that has lost the part t of
/// the sun keeps 1 - t S of its light, and its blue over its green changes by
///
///     (1 - t S_b) / (1 - t S_g) - 1  =  (1 - S_b / S_g) (1 - L) / L      (L of green)
///
/// So the hue may differ by h = min(0.14 (1 - L) / L, 0.11) and one standard deviation of the
/// square's noise. On the test ground 1 - S_b / S_g is 0.10 to 0.115, and L = 0.55 to 0.62 in full
/// shade; the hues of skin, sleeve and wood differ by more than 10 %.
///
/// **Chance.** A hand's shading passes through the desk's level in broad bands, and a gloss on it
/// may be as bright as white paper: some of its tiles look the same by chance. So each neighbour of
/// a changed tile that looks the same, or like nothing, is tested once more, over its square:
///
///     changed   its hue is off by more than h + 1/32 and two standard deviations
///     nothing   (only where a tile alone says too little, that is for squares of 3 x 3 and more)
///               its hue is off by more than h + 1/64 and one standard deviation: its depth decides
///
/// A tile that becomes changed or nothing has its own neighbours tested. Tiles whose depth is the
/// scene's are left out.
///
/// **Learning.** P takes over a tile at once. The tile is known after frames_to_trust frames in
/// which it goes on looking like that, or five times as many if the mask calls it moving. From then
/// on P follows Y by one level at most in every fourth frame, which makes it the median of Y in the
/// long run (Manzanera and Richefeu 2007).
class StaticPicture {
 public:
  /// kNothing: it cannot be said.
  enum Look : std::uint8_t { kNothing, kSame, kShadow, kChanged };

  /// @throws ContractViolation for settings out of their range
  explicit StaticPicture(const StaticPictureSettings& settings = {});

  /// Compares a frame with the picture. Allocates at the first frame of a size.
  /// @param luma       as large as the depth image, or twice as large
  /// @param color      as large as the depth image, or twice as large
  /// @param width      of the depth image, px
  /// @param height     of the depth image, px
  /// @param is_static  per tile: not 0 where its depth is the static scene's
  /// @return false for images of other sizes: nothing was compared
  bool compare(const GrayImage& luma, const ColorImage& color, int width, int height,
               const Image<std::uint8_t>& is_static);

  /// Compares a frame with a view that was drawn for it, for a camera that sways. A view may be off
  /// by a pixel: by its rounding, by the pose, by the rows of a rolling shutter. So a pixel is
  /// compared with the range of P over the 3 x 3 pixels around it: P is the value of that range
  /// which is nearest to Y.
  bool compare(const GrayImage& luma, const ColorImage& color, int width, int height,
               const Image<std::uint8_t>& is_static, const PictureView& view);

  /// Allocates for a size, which the first compare() would do.
  void resize(int width, int height, const Image<std::uint8_t>& tiles);

  /// The last frame's luma, at the depth's size.
  [[nodiscard]] const GrayImage& luma() const { return now_; }
  /// The last frame's colour of a tile; null where it was not computed. It is where the tile is not
  /// known, and with a view where the view asks for it.
  [[nodiscard]] const TileColor* color(int i, int j) const {
    return colored_(i, j) != 0 ? &colors_now_(i, j) : nullptr;
  }

  /// How a tile looks, by the last compare().
  [[nodiscard]] Look tile(int i, int j) const { return static_cast<Look>(look_(i, j)); }
  /// Whether a pixel and its eight neighbours look the same, by a_4 with n = 9. False at the
  /// image's border, and in a tile that is not known.
  [[nodiscard]] bool is_same_pixel(int x, int y) const;
  /// Whether a single pixel of the tile can be told from the scene: the bound that the noise sets
  /// is within P / 16. Where it is not, a pixel that looks the same may do so by chance.
  [[nodiscard]] bool tells_pixels(int i, int j) const;
  /// Whether a tile shows nothing but noise. The matcher finds no texture there, and its depth of
  /// the tile is taken over from the neighbours.
  [[nodiscard]] bool is_plain(int i, int j) const;
  /// Whether a tile and most of those around it look as the scene has since the picture was begun:
  /// in shadow, too, where it is plain. What was learnt anew, or while something moved there, may
  /// be something that has come, and counts as no look of the scene.
  [[nodiscard]] bool looks_as_ever(int i, int j) const;
  /// Whether this is one of the first frames, in which nothing can be known to move.
  [[nodiscard]] bool starting() const { return frame_ < 2 * settings_.frames_to_trust; }

  /// Learns from the frame of the last compare().
  /// @param moves      per tile: not 0 where something moves, or beside that
  /// @param is_static  as for compare()
  void learn(const Image<std::uint8_t>& moves, const Image<std::uint8_t>& is_static);

  /// Forgets all looks: the camera has moved in this frame.
  void forget();

 private:
  // Sums over those tiles of a square whose light has changed as that of its middle tile.
  struct Square {
    bool alone = false;                            // the square is a single tile
    int tiles = 0;                                 // that were summed
    int now = 0, expected = 0;                     // Y and g P
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

  static constexpr int kUnit = 512;  // a gain of 1

  StaticPictureSettings settings_;
  int trust_;                             // value of sure_ from which on a tile is known
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
  Image<std::uint8_t> sure_;      // per tile: 0: nothing is known .. trust_: known
  Image<std::uint8_t> anew_;      // per tile: not 0: it may show what has come (looks_as_ever())
  Image<std::uint16_t> strange_;  // per tile: frames in a row in which it had changed
  std::vector<std::uint16_t> columns_, columns_of_difference_;  // sums over four rows of pixels
  std::vector<std::uint8_t> scaled_;                            // a row of pixels times a gain
  std::vector<std::uint8_t> follows_;  // a row of pixels: 255 where P follows Y, else 0
  std::vector<int> histogram_;
  int gain_;               // g, of the picture, in 1 / kUnit
  int view_gain_ = kUnit;  // g of the last view
  double noise_ = -1;      // m, grey levels; < 0: not measured yet
  int frame_ = 0;          // frames so far
  // Bounds of the sum of D over a pixel and its neighbours, and of a tile. As long as the noise is
  // not known, no pixel is the same.
  int same_pixel_ = -1, changed_tile_ = 16 * 8;
};

}  // namespace palpable

/// @file
/// A picture of the static scene: how each pixel looks while nothing moves there. What has no
/// depth, or one that a matcher took over from its neighbour, is told from the scene by its look.
///
/// For a camera that stands; one that has moved forgets it. For one that sways the picture is drawn
/// anew in each frame (scene_canvas.h).
///
///   tile  a square of 4 x 4 pixels of the depth image
///   Y, P  luma of this frame and of the picture, 0 .. 255, of the depth image's size
#pragma once

#include "palpable/geometry/image.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace palpable {

/// Sums over eight pixels of a tile.
struct TileColor {
  std::uint16_t r = 0, g = 0, b = 0;
};

/// The static scene as a frame should show it, from elsewhere (scene_canvas.h).
struct PictureView {
  GrayImage luma;             ///< of the depth image's size
  Image<TileColor> colors;    ///< per tile
  Image<std::uint8_t> known;  ///< per tile: not 0 where the others say something
  Image<std::uint8_t> asks;   ///< per tile: not 0 where the frame's colour is wanted
};

struct StaticPictureSettings {
  int frames_to_trust = 6;  ///< in which a tile looks the same before it says anything, 1 .. 50
  /// A tile whose depth is the scene's but whose look is not is learnt anew after so many frames;
  /// not a shaded one: the shadow goes with the hand.
  int frames_to_renew = 24;
  /// So is any other that looks strange: what stays there is part of the scene (20 s at 30 fps).
  int frames_to_settle = 600;
};

/// Says of tiles and pixels whether they look as the static scene does.
///
/// **Exposure.** What light and camera do to all pixels is a gain g: the median of Y / P over the
/// tiles whose depth is the scene's. D = |Y - g P|.
///
/// **Noise.** m, the median over those tiles of the mean of D, is measured in each frame. For
/// normal noise of deviation s it is 0.8 s. The mean of n values of D scatters by 0.6 s / sqrt(n),
/// that of Y - g P by s / sqrt(n); sqrt(2) more, since rectification makes neighbours' noise alike.
/// In units of m that is 1.06 / sqrt(n) and 1.77 / sqrt(n). With k deviations:
///
///     a_k(n) = m (1 + 1.06 k / sqrt(n)) + 1/2      bound for the mean of D
///     b_k(n) = m 1.77 k / sqrt(n) + 1/2            and for the mean of Y - g P; 1/2: whole numbers
///
/// **Look** of a tile (n = 16):
///
///     same      mean D <= a_4 + P / 64  and  |mean (Y - g P)| <= b_3 + P / 128
///     changed   mean D > a_8 + P / 32  or  |mean (Y - g P)| > b_6 + P / 32
///     nothing   between them, or while the tile is not known
///
/// The shares of P are light that comes or goes and is no shadow: reflected by a hand.
///
/// **Squares.** In the dark the noise of one tile hides what differs by less than its bounds. Hue
/// and mean are compared over the smallest square of 1, 3 x 3 or 5 x 5 tiles whose hue the noise
/// leaves within that share, 1/32, or the largest. Of it those tiles count whose Y / P is the
/// middle one's within the noise, so a square does not reach across an edge.
///
/// **Shadow.** A changed tile that is darker, down to L = Y / g P = 0.4, and has the scene's hue.
/// With sun and sky, of which the sun gives a share S of red, green and blue, a place that has lost
/// the part t of the sun has 1 - t S of its light. Its blue over its green, against the picture's,
///
///     (1 - t S_b) / (1 - t S_g) - 1  =  (1 - S_b / S_g) (1 - L) / L      (L of green)
///
/// so the hue may be off by h = min(0.14 (1 - L) / L, 0.11) and a deviation of the square's noise.
/// On the test ground 1 - S_b / S_g is 0.10 to 0.115 and L = 0.55 to 0.62 in full shade; skin,
/// sleeve and wood differ by more than 10 %.
///
/// **Chance.** Beside a changed tile, one that looks the same or is between the bounds has changed
/// too if its square's mean is off by more than b_6(n) + P / 32, or its hue by more than h, 1 / 32
/// and two deviations: a hand's shading passes through the desk's level in broad bands, and a gloss
/// on it may have the level of white paper. Where a tile alone says little, half of these bounds is
/// as much as the same may be off by: between them it looks like nothing, and a depth decides. Not
/// where the depth is the scene's.
///
/// **Learning.** A tile is taken over once and known after frames_to_trust frames in which it looks
/// like that; five times as many when something is said to move there. From then on P follows Y by
/// at most one level every fourth frame, which makes it the median in the long run (Manzanera and
/// Richefeu 2007).
class StaticPicture {
 public:
  static constexpr int kTile = 4;  ///< px of the depth image, a tile's side
  enum Look : std::uint8_t { kNothing, kSame, kShadow, kChanged };

  /// @throws ContractViolation for settings out of their range
  explicit StaticPicture(const StaticPictureSettings& settings = {});

  /// Compares a frame. Takes memory at the first one of a size.
  /// @param luma       as large as the depth image or twice as large
  /// @param color      the same, but not necessarily as `luma`
  /// @param width      of the depth image, and
  /// @param height     px
  /// @param is_static  per tile: not 0 where its depth is the static scene's
  /// @return false for images of other sizes: nothing is said
  bool compare(const GrayImage& luma, const ColorImage& color, int width, int height,
               const Image<std::uint8_t>& is_static);

  /// The same for a camera that sways, with a view of the scene that was made for this frame
  /// instead of the picture. A view may be off by a pixel, by its rounding, by the pose and by the
  /// rows of a rolling shutter: of P in the 3 x 3 pixels around each one the value nearest to Y
  /// counts, between the least and the largest.
  bool compare(const GrayImage& luma, const ColorImage& color, int width, int height,
               const Image<std::uint8_t>& is_static, const PictureView& view);

  /// Takes the memory for a size, which the first compare() would do.
  void resize(int width, int height, const Image<std::uint8_t>& tiles);

  /// The last frame's luma, at the depth's size.
  [[nodiscard]] const GrayImage& luma() const { return now_; }
  /// Its colour of a tile, if that was looked at, as it is where the picture knows nothing and,
  /// with a view, the view asks for it; or null.
  [[nodiscard]] const TileColor* color(int i, int j) const {
    return colored_(i, j) != 0 ? &colors_now_(i, j) : nullptr;
  }

  /// Of a tile, by the last compare().
  [[nodiscard]] Look tile(int i, int j) const { return static_cast<Look>(look_(i, j)); }
  /// Of a pixel and its eight neighbours by a_4 and a_8 (n = 9), never a shadow; nothing at the
  /// border and in a tile that is shaded.
  [[nodiscard]] Look pixel(int x, int y) const;
  /// Whether a pixel of the tile that looks the same is no chance: the noise's bound is within
  /// P / 16.
  [[nodiscard]] bool tells_pixels(int i, int j) const;
  /// Whether a tile shows nothing but noise: a matcher's depth of it is its neighbours'.
  [[nodiscard]] bool is_plain(int i, int j) const;
  /// In the first frames, in which nothing can be known to move.
  [[nodiscard]] bool starting() const { return frame_ < 2 * settings_.frames_to_trust; }

  /// Takes in the frame of the last compare().
  /// @param moves      per tile: not 0 where something moves, or may
  /// @param is_static  as for compare()
  void learn(const Image<std::uint8_t>& moves, const Image<std::uint8_t>& is_static);

  /// The camera has moved in this frame: nothing is known any more.
  void forget();

 private:
  // Sums over those tiles of a square whose light has changed as that of its middle.
  struct Square {
    bool alone = false;  // its middle is enough
    int tiles = 0, now = 0, foretold = 0;
    std::array<int, 3> color_now{}, color_then{};
  };

  bool halve(const GrayImage& luma, const ColorImage& color, int width, int height,
             const Image<std::uint8_t>& tiles);
  void take_view(const PictureView& view);
  void take_nearest(const PictureView& view);
  void find_gain(const Image<std::uint8_t>& is_static);
  void find_differences();
  void find_noise(const Image<std::uint8_t>& is_static);
  void tell_looks(const ColorImage& color, const Image<std::uint8_t>& is_static,
                  const PictureView* view);
  void find_looks(const ColorImage& color, const Image<std::uint8_t>& is_static,
                  const PictureView* view);
  void spread_changes(const ColorImage& color, const Image<std::uint8_t>& is_static);
  void see_color(const ColorImage& color, int i, int j);
  [[nodiscard]] TileColor color_of(const ColorImage& color, int i, int j) const;
  [[nodiscard]] int foretold(int i, int j) const { return sum_then_(i, j) * gain_ / kUnit; }
  [[nodiscard]] double color_noise() const;
  [[nodiscard]] Square square_of(const ColorImage& color, int i, int j);
  [[nodiscard]] bool has_hue_of_scene(const Square& square, double bounds, double light) const;
  [[nodiscard]] bool has_mean_of_scene(const Square& square, double bounds) const;
  void take_over(int i, int j);
  void follow_row(int j);

  static constexpr int kUnit = 512;  // of the gain

  StaticPictureSettings settings_;
  int trust_;
  int factor_ = 1;            // the colours' size over the picture's
  int tiles_ = 0, rows_ = 0;  // whole ones
  GrayImage now_, picture_, difference_;
  GrayImage least_, largest_;  // of three rows of a view, over three pixels of each
  Image<std::uint16_t> sum_now_, sum_then_, sum_difference_;  // of the sixteen pixels of tiles
  Image<TileColor> colors_, colors_now_;
  Image<std::uint8_t> colored_;  // not 0: colors_now_ is this frame's
  Image<std::uint8_t> look_, tried_;
  std::vector<int> queue_;
  Image<std::uint8_t> sure_;      // 0: nothing is known; trust_: known
  Image<std::uint16_t> strange_;  // frames in a row in which a tile has changed
  std::vector<std::uint16_t> columns_, columns_of_difference_;
  std::vector<std::uint8_t> scaled_, follows_;  // a row of pixels
  std::vector<int> histogram_;
  int gain_;  // 1/512
  int view_gain_ = kUnit;
  double noise_ = -1;  // m; < 0: not measured yet
  int frame_ = 0;
  // Bounds for the sum of nine D: none is the same, none has changed; and of sixteen.
  int same_pixel_ = -1, changed_pixel_ = 9 * 255, changed_tile_ = 16 * 8;
};

}  // namespace palpable

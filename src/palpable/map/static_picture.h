/// @file
/// A picture of the static scene: how each pixel looks while nothing moves there. What has no
/// depth, or one that a matcher took over from its neighbour, is told from the scene by its look.
///
/// For a camera that stands; one that has moved forgets it.
///
///   tile  a square of 4 x 4 pixels of the depth image
///   Y, P  luma of this frame and of the picture, 0 .. 255, of the depth image's size
#pragma once

#include "palpable/geometry/image.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace palpable {

struct StaticPictureSettings {
  int frames_to_trust = 6;  ///< in which a tile looks the same before it says anything, 1 .. 50
  /// A tile whose depth is the scene's but whose look is not is learnt anew after so many frames.
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
/// The shares of P are light that comes or goes and is no shadow: reflected by a hand. A changed
/// tile that is darker, down to 0.4 g P, and whose hue is the scene's within 7 % + m / P is a
/// **shadow**: there Y / P is alike in red, green and blue up to the difference between sun and
/// sky. Skin, sleeve and wood differ by more than 10 %.
///
/// **Learning.** A tile is taken over once and known after frames_to_trust frames in which it looks
/// like that; five times as many when something is said to move there. From then on P follows Y by
/// at most one level every fourth frame, which makes it the median in the long run (Manzanera and
/// Richefeu 2007).
class StaticPicture {
 public:
  enum Look : std::uint8_t { kNothing, kSame, kShadow, kChanged };

  /// @throws ContractViolation for settings out of their range
  explicit StaticPicture(const StaticPictureSettings& settings = {});

  /// Compares a frame. Takes memory at the first one of a size.
  /// @param luma       as large as the depth image or twice as large
  /// @param color      as large as `luma`
  /// @param width      of the depth image, and
  /// @param height     px
  /// @param is_static  per tile: not 0 where its depth is the static scene's
  /// @return false for images of other sizes: nothing is said
  bool compare(const GrayImage& luma, const ColorImage& color, int width, int height,
               const Image<std::uint8_t>& is_static);

  /// Of a tile, by the last compare().
  [[nodiscard]] Look tile(int i, int j) const { return static_cast<Look>(look_(i, j)); }
  /// Of a pixel and its eight neighbours by a_4 and a_8 (n = 9), never a shadow; nothing at the
  /// border and in a tile that is shaded.
  [[nodiscard]] Look pixel(int x, int y) const;
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
  struct TileColor {  // sums over eight pixels
    std::uint16_t r = 0, g = 0, b = 0;
  };

  void resize(int width, int height, const Image<std::uint8_t>& tiles);
  void find_gain(const Image<std::uint8_t>& is_static);
  void find_differences();
  void find_noise(const Image<std::uint8_t>& is_static);
  void find_looks(const ColorImage& color);
  [[nodiscard]] TileColor color_of(const ColorImage& color, int i, int j) const;
  [[nodiscard]] bool has_hue_of_scene(int i, int j, int foretold) const;
  void take_over(int i, int j);
  void follow_row(int j);

  StaticPictureSettings settings_;
  int trust_;
  int factor_ = 1;            // luma's size over the picture's
  int tiles_ = 0, rows_ = 0;  // whole ones
  GrayImage now_, picture_, difference_;
  Image<std::uint16_t> sum_now_, sum_then_, sum_difference_;  // of the sixteen pixels of tiles
  Image<TileColor> colors_, colors_now_;
  Image<std::uint8_t> look_;
  Image<std::uint8_t> sure_;      // 0: nothing is known; trust_: known
  Image<std::uint16_t> strange_;  // frames in a row in which a tile has changed
  std::vector<std::uint16_t> columns_;
  std::vector<std::uint8_t> scaled_, follows_;  // a row of pixels
  std::vector<int> histogram_;
  int gain_;           // 1/512
  double noise_ = -1;  // m; < 0: not measured yet
  int frame_ = 0;
  // Bounds for the sum of nine D: none is the same, none has changed; and of sixteen.
  int same_pixel_ = -1, changed_pixel_ = 9 * 255, changed_tile_ = 16 * 8;
};

}  // namespace palpable

#include "palpable/live/map/mask_outline.h"

#include "palpable/common/base/contract.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <hwy/base.h>
#include <limits>

namespace palpable {
namespace {

// Values of the mask's pixels while it is computed; kOpen is undecided.
constexpr std::uint8_t kOff = 0, kOpen = 128, kOn = 255;

// px: longest run of pixels without depth between moving ones that counts as a hole in a hand. A
// longer run is the background between two fingers.
constexpr int kLongestHole = 24;

// HWY_RESTRICT declares that arrays do not overlap, which the compiler cannot infer for members. It
// can then vectorise the loops.

// Compares pixels with one tile: where the tile's depth is nearer to the pixel's than those of the
// tiles before, the pixel's value becomes the tile's.
// @param least  the smallest difference of depth so far, as the bits of a float >= 0; these bits
//               as integers have the order of the floats, with NaN last
void use_if_nearest(float there, std::int32_t value_there, const float* HWY_RESTRICT depth,
                    std::int32_t* HWY_RESTRICT least, std::int32_t* HWY_RESTRICT value, int count) {
  for (int k = 0; k < count; ++k) {
    const auto difference = std::bit_cast<std::int32_t>(std::abs(there - depth[k]));
    const std::int32_t nearer = difference < least[k] ? -1 : 0;
    value[k] ^= (value[k] ^ value_there) & nearer;
    least[k] ^= (least[k] ^ difference) & nearer;
  }
}

void any_of_three(const std::uint8_t* a, const std::uint8_t* b, const std::uint8_t* c,
                  std::uint8_t* HWY_RESTRICT any, int count) {
  for (int i = 0; i < count; ++i) any[i] = a[i] | b[i] | c[i];
}

void all_of_three(const std::uint8_t* a, const std::uint8_t* b, const std::uint8_t* c,
                  std::uint8_t* HWY_RESTRICT all, int count) {
  for (int i = 0; i < count; ++i) all[i] = a[i] & b[i] & c[i];
}

}  // namespace

MaskOutline::MaskOutline(int grow_px) : grow_px_(grow_px) {
  PALPABLE_EXPECT(grow_px >= 0, "a margin is not negative");
}

void MaskOutline::resize(int width, int height) {
  const int tiles = (width + kTile - 1) / kTile, rows = (height + kTile - 1) / kTile;
  mask_ = above_ = below_ = MaskImage(width, height);
  open_.reserve(mask_.size());
  near_ = inside_ = any_beside_ = all_beside_ = Image<std::uint8_t>(tiles, rows);
  row_.resize(tiles + 2);
  row_is_empty_.assign(rows, 1);
}

// Sets near_ and inside_: tiles that move or have a neighbour that moves, and tiles that move with
// all their neighbours.
void MaskOutline::find_border(const Image<std::uint8_t>& moves) {
  const int width = moves.width(), height = moves.height();
  for (int j = 0; j < height; ++j) {  // horizontally
    std::uint8_t* row = row_.data() + 1;
    std::copy_n(moves.row(j), width, row);
    row[-1] = row[0];
    row[width] = row[width - 1];
    any_of_three(row - 1, row, row + 1, any_beside_.row(j), width);
    all_of_three(row - 1, row, row + 1, all_beside_.row(j), width);
  }
  for (int j = 0; j < height; ++j) {  // vertically
    const int above = std::max(j - 1, 0), below = std::min(j + 1, height - 1);
    any_of_three(any_beside_.row(above), any_beside_.row(j), any_beside_.row(below), near_.row(j),
                 width);
    all_of_three(all_beside_.row(above), all_beside_.row(j), all_beside_.row(below), inside_.row(j),
                 width);
  }
}

const MaskImage& MaskOutline::draw(const DepthImage& depth, const DepthImage& tile_depth,
                                   const Image<std::uint8_t>& moves, const Look& look) {
  find_border(moves);
  const int width = moves.width(), height = moves.height();
  for (int j = 0; j < height; ++j) {
    const int y0 = kTile * j, y1 = std::min(y0 + kTile, depth.height());
    std::uint8_t* first = mask_.row(y0);
    const std::uint8_t *near = near_.row(j), *inside = inside_.row(j);
    const bool was_empty = row_is_empty_[j] != 0;
    const bool is_empty = std::memchr(near, 1, static_cast<std::size_t>(width)) == nullptr;
    row_is_empty_[j] = is_empty ? 1 : 0;
    if (is_empty) {
      if (!was_empty) std::fill(first, mask_.row(y1 - 1) + depth.width(), kOff);
      continue;
    }
    for (int i = 0; i < width - 1; ++i)
      std::memset(first + kTile * i, inside[i] != 0 ? kOn : kOff, kTile);
    std::fill(first + kTile * (width - 1), first + depth.width(),
              inside[width - 1] != 0 ? kOn : kOff);
    for (int y = y0 + 1; y < y1; ++y) std::copy_n(first, depth.width(), mask_.row(y));
    for (int i = 0; i < width; ++i) {
      if (near[i] != 0 && inside[i] == 0) draw_border(depth, tile_depth, moves, look, i, j);
    }
  }
  close_rows();
  close_columns();
  return mask_;
}

// Decides the pixels of a border tile by look and depth; those of unknown depth stay open.
void MaskOutline::draw_border(const DepthImage& depth, const DepthImage& tile_depth,
                              const Image<std::uint8_t>& moves, const Look& look, int i, int j) {
  const int width = moves.width(), height = moves.height();
  const int x0 = kTile * i, x1 = std::min(x0 + kTile, depth.width());
  const int y0 = kTile * j, y1 = std::min(y0 + kTile, depth.height());
  const bool tile_moves = moves(i, j) != 0, measured = !std::isnan(tile_depth(i, j));
  const bool too_close = tile_moves && !measured;
  // Whether a pixel that looks the same is taken for the scene. In the dark that may be chance.
  const bool same_is_scene =
      look.picture != nullptr &&
      (!tile_moves || (look.picture->distinguishes_pixels(i, j) && !(measured && look.may_be_off)));
  // Each tile is compared with all sixteen pixels at once.
  std::array<float, kTile * kTile> Z;
  std::array<std::int32_t, kTile * kTile> least, value;
  Z.fill(std::numeric_limits<float>::quiet_NaN());
  for (int y = y0; y < y1; ++y)
    std::copy(depth.row(y) + x0, depth.row(y) + x1, &Z[kTile * (y - y0)]);
  least.fill(std::bit_cast<std::int32_t>(std::numeric_limits<float>::infinity()));
  for (std::size_t k = 0; k < Z.size(); ++k) value[k] = too_close && std::isnan(Z[k]) ? kOn : kOpen;
  for (int b = std::max(j - 1, 0); b <= std::min(j + 1, height - 1); ++b) {
    for (int a = std::max(i - 1, 0); a <= std::min(i + 1, width - 1); ++a) {
      use_if_nearest(tile_depth(a, b), moves(a, b) != 0 ? kOn : kOff, Z.data(), least.data(),
                     value.data(), kTile * (y1 - y0));
    }
  }
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) {
      auto of_pixel = static_cast<std::uint8_t>(value[kTile * (y - y0) + x - x0]);
      if (same_is_scene && of_pixel != kOff && look.picture->is_same_pixel(x, y)) of_pixel = kOff;
      mask_(x, y) = of_pixel;
    }
  }
}

// Decides open pixels by the moving ones in their rows, and lists those that stay open in open_.
void MaskOutline::close_rows() {
  const int width = mask_.width(), height = mask_.height();
  open_.clear();
  for (int y = 0; y < height; ++y) {
    if (row_is_empty_[y / kTile] != 0) continue;
    std::uint8_t* row = mask_.row(y);
    for (int x = 0; x < width;) {
      const auto* next = static_cast<const std::uint8_t*>(
          std::memchr(row + x, kOpen, static_cast<std::size_t>(width - x)));
      if (next == nullptr) break;
      x = static_cast<int>(next - row);
      int end = x;
      while (end < width && row[end] == kOpen) ++end;
      const std::uint8_t left = x > 0 ? row[x - 1] : row[std::min(end, width - 1)];
      const std::uint8_t right = end < width ? row[end] : left;
      if (left == kOn && right == kOn && end - x <= kLongestHole) {
        std::fill(row + x, row + end, kOn);
      } else {
        const int grow = std::min(grow_px_, end - x);
        if (left == kOn) std::fill(row + x, row + x + grow, kOn);
        if (right == kOn) std::fill(row + end - grow, row + end, kOn);
        for (int k = x; k < end; ++k) {
          if (row[k] == kOpen) open_.push_back(y * width + k);
        }
      }
      x = end;
    }
  }
}

// Decides the remaining open pixels by the moving ones in their columns.
void MaskOutline::close_columns() {
  const int width = mask_.width(), height = mask_.height();
  // Distance, in px, of the next moving pixel in one direction if only open pixels lie between; 255
  // if there is none.
  const auto away = [&](int k, int step, const MaskImage& distance) -> std::uint8_t {
    const int to = k + step;
    if (to < 0 || to >= width * height) return 255;
    if (mask_.data()[to] == kOn) return 1;
    if (mask_.data()[to] == kOff) return 255;
    return static_cast<std::uint8_t>(std::min(distance.data()[to] + 1, 255));
  };
  for (const int k : open_) above_.data()[k] = away(k, -width, above_);
  for (auto k = open_.rbegin(); k != open_.rend(); ++k) {
    below_.data()[*k] = away(*k, width, below_);
  }
  for (const int k : open_) {
    const int above = above_.data()[k], below = below_.data()[k];
    const bool inside = above + below - 1 <= kLongestHole;
    mask_.data()[k] = inside || std::min(above, below) <= grow_px_ ? kOn : kOff;
  }
}

}  // namespace palpable

#include "palpable/live/seen_object/color_outline.h"

#include "palpable/common/base/contract.h"

#include <algorithm>
#include <cmath>

namespace palpable {
namespace {

constexpr int kColorCell = 8;  // px

// Bounds of a thing's brightness at its outline, as ratios to that of its inside.
constexpr float kDarkestShade = 0.5F, kLightestShade = 1.2F;
// A colour has another hue than a thing if the sum of squared differences (three channels) from the
// nearest shade of the thing exceeds this, in units of least_spread^2.
constexpr float kOtherHue = 12;

constexpr std::array<std::array<int, 2>, 4> kBesides{{{-1, 0}, {1, 0}, {0, -1}, {0, 1}}};

}  // namespace

ColorOutline::ColorOutline(const ColorOutlineSettings& settings) : settings_(settings) {
  PALPABLE_EXPECT(settings.band >= 0 && settings.band < 255 && settings.least_spread > 0 &&
                      settings.apart >= 0 && settings.fewest >= 1,
                  "a band is not negative, colours differ by more than nothing");
}

void ColorOutline::Side::add(const Side& other) {
  count += other.count;
  for (std::size_t c = 0; c < 3; ++c) sum[c] += other.sum[c], square[c] += other.square[c];
}

ColorOutline::Color ColorOutline::color_at(const SeenFrame& seen, int x, int y) const {
  const Rgb a = seen.color(factor_ * x, factor_ * y);
  const Rgb b = seen.color(factor_ * x + factor_ - 1, factor_ * y + factor_ - 1);
  return {0.5F * static_cast<float>(a.r + b.r), 0.5F * static_cast<float>(a.g + b.g),
          0.5F * static_cast<float>(a.b + b.b)};
}

// Finds the pixels of things that are at most `band` steps away from the room.
void ColorOutline::find_band(const PixelBox& box, const MaskImage& shows) {
  band_.clear();
  const int right = box.x + box.width, bottom = box.y + box.height;
  for (int y = box.y + 1; y + 1 < bottom; ++y) {
    const std::uint8_t *row = shows.row(y), *above = shows.row(y - 1), *below = shows.row(y + 1);
    for (int x = box.x + 1; x + 1 < right; ++x) {
      if (row[x] != kShowsPresser) continue;
      if (row[x - 1] != kShowsRoom && row[x + 1] != kShowsRoom && above[x] != kShowsRoom &&
          below[x] != kShowsRoom) {
        continue;
      }
      in_band_(x, y) = 1;
      band_.push_back({static_cast<std::int16_t>(x), static_cast<std::int16_t>(y)});
    }
  }
  std::size_t first = 0;
  for (int step = 1; step < settings_.band; ++step) {
    const std::size_t last = band_.size();
    for (; first < last; ++first) {
      const Place from = band_[first];
      for (const auto& [dx, dy] : kBesides) {
        const int x = from.x + dx, y = from.y + dy;
        if (!box.contains(x, y) || shows(x, y) != kShowsPresser || in_band_(x, y) != 0) continue;
        in_band_(x, y) = 1;
        band_.push_back({static_cast<std::int16_t>(x), static_cast<std::int16_t>(y)});
      }
    }
  }
}

// The sums over every second pixel of a cell.
const ColorOutline::Cell& ColorOutline::summed(const SeenFrame& seen, const MaskImage& shows, int i,
                                               int j) {
  Cell& cell = cells_[index(i, j)];
  if (cell.is_summed) return cell;
  summed_.push_back(index(i, j));
  cell.is_summed = true;
  cell.thing = cell.room = {};
  const int right = std::min(kColorCell * (i + 1), box_.x + box_.width);
  const int bottom = std::min(kColorCell * (j + 1), box_.y + box_.height);
  for (int y = std::max(kColorCell * j, box_.y); y < bottom; ++y) {
    for (int x = std::max(kColorCell * i, box_.x) + y % 2; x < right; x += 2) {
      // The band is left out: its pixels are the ones that trim() is reassigning.
      if (in_band_(x, y) != 0 || shows(x, y) == kShowsUnknown) continue;
      Side& side = shows(x, y) == kShowsPresser ? cell.thing : cell.room;
      const Color color = color_at(seen, x, y);
      side.count += 1;
      for (std::size_t c = 0; c < 3; ++c) {
        side.sum[c] += color[c], side.square[c] += color[c] * color[c];
      }
    }
  }
  return cell;
}

// The colours of both sides around a cell, and whether they differ enough.
const ColorOutline::Cell& ColorOutline::compared(const SeenFrame& seen, const MaskImage& shows,
                                                 int i, int j) {
  Cell& cell = cells_[index(i, j)];
  if (cell.is_compared) return cell;
  Side thing, room;
  for (int b = std::max(j - 1, 0); b <= std::min(j + 1, down_ - 1); ++b) {
    for (int a = std::max(i - 1, 0); a <= std::min(i + 1, across_ - 1); ++a) {
      const Cell& beside = summed(seen, shows, a, b);
      thing.add(beside.thing);
      room.add(beside.room);
    }
  }
  cell.is_compared = true;
  cell.differs = false;
  const auto fewest = static_cast<float>(settings_.fewest);
  if (thing.count < fewest || room.count < fewest) return cell;
  const auto least = static_cast<float>(settings_.least_spread * settings_.least_spread);
  float apart = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto spread = [&](const Side& side, float mean) {
      return std::max(side.square[c] / side.count - mean * mean, 0.0F) + least;
    };
    const float of_thing = thing.sum[c] / thing.count, of_room = room.sum[c] / room.count;
    cell.thing_mean[c] = of_thing, cell.room_mean[c] = of_room;
    cell.thing_weight[c] = 1 / spread(thing, of_thing);
    cell.room_weight[c] = 1 / spread(room, of_room);
    apart += (of_thing - of_room) * (of_thing - of_room) *
             std::min(cell.thing_weight[c], cell.room_weight[c]);
  }
  cell.differs = apart > static_cast<float>(settings_.apart * settings_.apart);
  return cell;
}

// Whether a pixel's colour is like that of the room beside it, and unlike every shade of the thing.
bool ColorOutline::is_room(const SeenFrame& seen, const MaskImage& shows, int x, int y) {
  const Cell& cell = compared(seen, shows, x / kColorCell, y / kColorCell);
  if (!cell.differs) return false;
  const Color color = color_at(seen, x, y);
  float from_thing = 0, from_room = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const float a = color[c] - cell.thing_mean[c], b = color[c] - cell.room_mean[c];
    from_thing += a * a * cell.thing_weight[c];
    from_room += b * b * cell.room_weight[c];
  }
  if (!(from_room < from_thing)) return false;
  // Towards its outline a thing may be darker or lighter than inside, with the same hue.
  float along = 0, square = 0, off = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    along += color[c] * cell.thing_mean[c];
    square += cell.thing_mean[c] * cell.thing_mean[c];
  }
  const float shade = std::clamp(square > 0 ? along / square : 1, kDarkestShade, kLightestShade);
  for (std::size_t c = 0; c < 3; ++c) {
    const float from_shade = color[c] - shade * cell.thing_mean[c];
    off += from_shade * from_shade;
  }
  const auto least = static_cast<float>(settings_.least_spread * settings_.least_spread);
  return off > kOtherHue * least;
}

// Marks the room within two pixels of outlines that were confirmed by colour.
void ColorOutline::mark_known(const SeenFrame& seen, const PixelBox& box, MaskImage& shows) {
  for (const Place& at : band_) {
    if (shows(at.x, at.y) != kShowsPresser ||
        !compared(seen, shows, at.x / kColorCell, at.y / kColorCell).differs) {
      continue;
    }
    for (const auto& d : kBesides) {
      const int x = at.x + d[0], y = at.y + d[1];
      if (!box.contains(x, y) || !shows_room(shows(x, y))) continue;
      for (int v = std::max(y - 1, box.y); v < std::min(y + 2, box.y + box.height); ++v) {
        for (int u = std::max(x - 1, box.x); u < std::min(x + 2, box.x + box.width); ++u) {
          if (shows(u, v) == kShowsRoom) shows(u, v) = kShowsRoomByColor;
        }
      }
    }
  }
}

void ColorOutline::trim(const SeenFrame& seen, const PixelBox& box, MaskImage& shows) {
  const int width = shows.width(), height = shows.height();
  factor_ = seen.color.width() / std::max(width, 1);
  if (settings_.band == 0 || factor_ < 1 || seen.color.height() < factor_ * height) return;
  if (in_band_.width() != width || in_band_.height() != height) {
    in_band_ = GrayImage(width, height);
    across_ = (width + kColorCell - 1) / kColorCell, down_ = (height + kColorCell - 1) / kColorCell;
    cells_.assign(static_cast<std::size_t>(across_) * static_cast<std::size_t>(down_), {});
    band_.reserve(shows.size());
    summed_.reserve(cells_.size());
  }
  box_ = box;
  find_band(box, shows);
  // From the outline inwards: a pixel can go to the room only if a neighbour belongs to the room.
  for (const Place& at : band_) {
    const bool is_beside =
        std::any_of(kBesides.begin(), kBesides.end(), [&](const std::array<int, 2>& d) {
          const int x = at.x + d[0], y = at.y + d[1];
          return box.contains(x, y) && shows(x, y) == kShowsRoom;
        });
    if (is_beside && is_room(seen, shows, at.x, at.y)) shows(at.x, at.y) = kShowsRoom;
  }
  mark_known(seen, box, shows);
  for (const Place& at : band_) in_band_(at.x, at.y) = 0;
  for (const std::size_t at : summed_) cells_[at].is_summed = cells_[at].is_compared = false;
  summed_.clear();
}

}  // namespace palpable

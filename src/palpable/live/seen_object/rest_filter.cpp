#include "palpable/live/seen_object/rest_filter.h"

#include "palpable/common/base/contract.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace palpable {
namespace {

constexpr float kPresent = 0.5f;  // a pixel shows a thing when its presence is larger

// px around the box that are copied unfiltered. Must be at least SilhouetteSettings::longest_hole.
constexpr int kBesidePixels = 16;

// Pixels: a cell with fewer has no shift of its own and takes its neighbours' weight.
constexpr float kFewest = 12;
// Cells to each side over which creeping is measured, and the pixels of things, and of outlines,
// that they must have.
constexpr std::ptrdiff_t kAround = 2;
constexpr float kFewestAround = 150, kFewestOutline = 20;

// Whether a neighbour is the room beside an outline that was found in the picture.
bool beside_edge(const MaskImage& shows, int x, int y) {
  return (x > 0 && shows(x - 1, y) == kShowsRoomByEdge) ||
         (x + 1 < shows.width() && shows(x + 1, y) == kShowsRoomByEdge) ||
         (y > 0 && shows(x, y - 1) == kShowsRoomByEdge) ||
         (y + 1 < shows.height() && shows(x, y + 1) == kShowsRoomByEdge);
}

}  // namespace

RestFilter::RestFilter(const RestFilterSettings& settings) : settings_(settings) {
  PALPABLE_EXPECT(settings.rests >= 0 && settings.moves > settings.rests && settings.sigmas > 0,
                  "what moves shifts by more than what rests");
  PALPABLE_EXPECT(settings.creeps >= 0 && settings.flows > settings.creeps,
                  "what flows shifts by more than what creeps");
  PALPABLE_EXPECT(settings.most_frames >= 1 && settings.cell_px >= 1,
                  "one frame and one pixel at least");
}

void RestFilter::start(const DepthImage& depth, const MaskImage& shows, const PixelBox& box,
                       const Rigid3& camera_from_body) {
  const bool stands = camera_from_body.matrix() == camera_from_body_.matrix() &&
                      presence_.width() == depth.width() && presence_.height() == depth.height();
  if (!stands) {
    average_.resize(depth.width(), depth.height());
    presence_.resize(depth.width(), depth.height());
    std::fill(presence_.begin(), presence_.end(), 0.0f);
    cells_across_ = static_cast<std::size_t>(depth.width() / settings_.cell_px) + 1;
    cell_of_column_.resize(static_cast<std::size_t>(depth.width()));
    for (std::size_t x = 0; x < cell_of_column_.size(); ++x) {
      cell_of_column_[x] = static_cast<int>(x) / settings_.cell_px;
    }
    cells_.assign(cells_across_ * static_cast<std::size_t>(depth.height() / settings_.cell_px + 1),
                  {});
    moved_.resize(cells_.size());
    remembered_ = {};
    camera_from_body_ = camera_from_body;
  }
  depth_.resize(depth.width(), depth.height());
  shows_.resize(depth.width(), depth.height());
  box_ = united(remembered_, box);
  const int first = std::max(box_.y - kBesidePixels, 0);
  const int last = std::min(box_.y + box_.height + kBesidePixels, depth.height());
  const int left = std::max(box_.x - kBesidePixels, 0);
  const int right = std::min(box_.x + box_.width + kBesidePixels, depth.width());
  for (int y = first; y < last; ++y) {
    std::copy(depth.row(y) + left, depth.row(y) + right, depth_.row(y) + left);
    std::copy(shows.row(y) + left, shows.row(y) + right, shows_.row(y) + left);
  }
}

void RestFilter::sum_up(const DepthImage& depth, const MaskImage& shows) {
  for (Cell& cell : cells_) cell = {.frames = cell.frames};
  const auto width = static_cast<std::ptrdiff_t>(depth.width());
  for (int y = box_.y; y < box_.y + box_.height; ++y) {
    Cell* cells = row_of_cells(y);
    const std::uint8_t* shown = shows.row(y);
    const float *depths = depth.row(y), *averages = average_.row(y), *presences = presence_.row(y);
    const int* cell_of_column = cell_of_column_.data();
    for (int x = box_.x; x < box_.x + box_.width; ++x) {
      const bool now = shown[x] == kShowsPresser, was = presences[x] > kPresent;
      if (!now && !was) continue;
      Cell& cell = cells[cell_of_column[x]];
      // A hole without depth does not mean that the thing has gone.
      if (now != was && shown[x] != kShowsUnknown) {
        cell.changed += 1;
        add_outline(shows, x, y, now ? 1.0f : -1.0f, cell.outline);
      }
      if (!now) continue;
      cell.now += 1;
      cell.depth += depths[x];
      const bool inner = x > 0 && y > 0 && x + 1 < depth.width() && y + 1 < depth.height() &&
                         shown[x - 1] == kShowsPresser && shown[x + 1] == kShowsPresser &&
                         shown[x - width] == kShowsPresser && shown[x + width] == kShowsPresser;
      if (!inner) {
        cell.edge += 1;
        if (was) add_outline(shows, x, y, 0, cell.outline);
      }
      if (!was) continue;
      cell.both += 1;
      cell.apart += depths[x] - averages[x];
    }
  }
}

// Adds a pixel to the normal equations of the outline's displacement.
// @param came  1: the pixel came, -1: it went, 0: it lies on the outline now
void RestFilter::add_outline(const MaskImage& shows, int x, int y, float came,
                             Outline& outline) const {
  // The normal: down the gradient of the thing's presence, now and before, over 3 x 3 pixels.
  float nx = 0, ny = 0;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const int u = x + dx, v = y + dy;
      if (u < 0 || v < 0 || u >= shows.width() || v >= shows.height()) continue;
      const float inside = (shows(u, v) == kShowsPresser ? 1.0f : 0.0f) + presence_(u, v);
      nx -= static_cast<float>(dx) * inside;
      ny -= static_cast<float>(dy) * inside;
    }
  }
  const float length = std::sqrt(nx * nx + ny * ny);
  if (!(length > 0)) return;
  nx /= length;
  ny /= length;
  if (came == 0) {
    outline.xx += nx * nx;
    outline.xy += nx * ny;
    outline.yy += ny * ny;
  } else {
    outline.x += came * nx;
    outline.y += came * ny;
  }
}

// The shift (m) of a cell and those around it together; 0 where they have too few pixels.
float RestFilter::shift_around(std::ptrdiff_t column, std::ptrdiff_t row, float fx_px) const {
  const auto across = static_cast<std::ptrdiff_t>(cells_across_);
  const auto down = static_cast<std::ptrdiff_t>(cells_.size()) / across;
  float now = 0, both = 0, apart = 0, depth = 0;
  Outline o;
  for (std::ptrdiff_t b = std::max<std::ptrdiff_t>(row - kAround, 0);
       b <= std::min(row + kAround, down - 1); ++b) {
    for (std::ptrdiff_t a = std::max<std::ptrdiff_t>(column - kAround, 0);
         a <= std::min(column + kAround, across - 1); ++a) {
      const Cell& cell = cells_[static_cast<std::size_t>(b * across + a)];
      now += cell.now;
      both += cell.both;
      apart += cell.apart;
      depth += cell.depth;
      o.xx += cell.outline.xx;
      o.xy += cell.outline.xy;
      o.yy += cell.outline.yy;
      o.x += cell.outline.x;
      o.y += cell.outline.y;
    }
  }
  const float away = both > kFewestAround ? std::abs(apart / both) : 0;
  if (!(o.xx + o.yy > kFewestOutline) || !(now > 0)) return away;
  // A straight outline does not determine d along itself: regularised, d is the shortest solution.
  const float least = 0.1f * (o.xx + o.yy);
  const float xx = o.xx + least, yy = o.yy + least, det = xx * yy - o.xy * o.xy;
  const float dx = (yy * o.x - o.xy * o.y) / det, dy = (xx * o.y - o.xy * o.x) / det;
  return std::max(away, std::sqrt(dx * dx + dy * dy) * depth / now / fx_px);
}

void RestFilter::find_shares(const PinholeCamera& camera) {
  const auto rests = static_cast<float>(settings_.rests),
             moves = static_cast<float>(settings_.moves);
  for (std::size_t k = 0; k < cells_.size(); ++k) {
    Cell& cell = cells_[k];
    moved_[k] = 0;
    if (cell.now + cell.changed < kFewest) continue;
    const float m_per_px = cell.now > 0 ? cell.depth / cell.now / static_cast<float>(camera.fx_px)
                                        : moves;  // the thing has left the cell
    const float along =
        m_per_px * cell.changed / std::max(cell.edge, static_cast<float>(settings_.cell_px));
    const float away = cell.both > 0 ? std::abs(cell.apart / cell.both) : moves;
    const float shift = std::max(along, cell.both > kFewest ? away : 0);
    moved_[k] = std::clamp((shift - rests) / (moves - rests), 0.0f, 1.0f);
    if (cell.frames == 0) moved_[k] = 1;
  }
  const auto creeps = static_cast<float>(settings_.creeps),
             flows = static_cast<float>(settings_.flows);
  const auto across = static_cast<std::ptrdiff_t>(cells_across_);
  const auto down = static_cast<std::ptrdiff_t>(cells_.size()) / across;
  for (std::ptrdiff_t j = 0; j < down; ++j) {
    for (std::ptrdiff_t i = 0; i < across; ++i) {
      Cell& cell = cells_[static_cast<std::size_t>(j * across + i)];
      if (cell.now + cell.changed == 0) {
        cell.frames = 0;
        continue;
      }
      const float around = shift_around(i, j, static_cast<float>(camera.fx_px));
      float moved = std::clamp((around - creeps) / (flows - creeps), 0.0f, 1.0f);
      for (std::ptrdiff_t b = std::max<std::ptrdiff_t>(j - 1, 0); b <= std::min(j + 1, down - 1);
           ++b) {
        for (std::ptrdiff_t a = std::max<std::ptrdiff_t>(i - 1, 0);
             a <= std::min(i + 1, across - 1); ++a) {
          moved = std::max(moved, moved_[static_cast<std::size_t>(b * across + a)]);
        }
      }
      const float frames = std::min(cell.frames + 1, static_cast<float>(settings_.most_frames));
      cell.share = std::max(1 / frames, moved);
      cell.frames = 1 / cell.share;
    }
  }
}

void RestFilter::average(const DepthImage& depth, const MaskImage& shows, const PixelBox& box,
                         const Image<float>* coverage, float gate_at_1m) {
  int left = box_.x + box_.width, right = -1, top = box_.y + box_.height, bottom = -1;
  for (int y = box_.y; y < box_.y + box_.height; ++y) {
    const Cell* cells = row_of_cells(y);
    const std::uint8_t* shown = shows.row(y);
    const float* depths = depth.row(y);
    float *averages = average_.row(y), *presences = presence_.row(y), *averaged = depth_.row(y);
    std::uint8_t* shows_averaged = shows_.row(y);
    const int* cell_of_column = cell_of_column_.data();
    for (int x = box_.x; x < box_.x + box_.width; ++x) {
      float presence = presences[x];
      const bool now = shown[x] == kShowsPresser;
      // Pixels outside the box of this frame may have a presence, but no coverage.
      float covered = now ? 1.0f : 0.0f;
      if (coverage != nullptr && box.contains(x, y)) covered = (*coverage)(x, y);
      if (!now) covered = std::min(covered, kPresent);  // it has no depth of the thing
      if (!now && presence == 0 && covered == 0) continue;
      const float share = cells[cell_of_column[x]].share;
      if (now) {
        const float z = depths[x], mean = averages[x];
        const bool same = presence > 0 && std::abs(z - mean) < gate_at_1m * z * z;
        averages[x] = same ? mean + share * (z - mean) : z;
        presence += share * (covered - presence);
      } else {
        if (presence == 0) averages[x] = 0;  // no depth yet: the next one begins anew
        // A hole without depth does not mean that a resting thing has gone.
        if (share >= 1 || shown[x] != kShowsUnknown) presence += share * (covered - presence);
        if (presence < 1e-3f) presence = 0;
      }
      presences[x] = presence;
      if (presence > 0) {
        left = std::min(left, x), right = std::max(right, x);
        top = std::min(top, y), bottom = y;
      }
      if (presence > kPresent) {
        averaged[x] = averages[x];
        shows_averaged[x] = kShowsPresser;
      } else if (now) {
        shows_averaged[x] = beside_edge(shows, x, y) ? kShowsRoomByEdge : kShowsRoom;
      }
    }
  }
  remembered_ = right < 0 ? PixelBox{} : PixelBox{left, top, right - left + 1, bottom - top + 1};
}

void RestFilter::add(const DepthImage& depth, const MaskImage& shows, const PixelBox& box,
                     const PinholeCamera& camera, const Rigid3& camera_from_body, double noise,
                     const Image<float>* coverage) {
  start(depth, shows, box, camera_from_body);
  sum_up(depth, shows);
  find_shares(camera);
  average(depth, shows, box, coverage, static_cast<float>(settings_.sigmas * noise));
}

}  // namespace palpable

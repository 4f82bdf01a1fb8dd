/// @file
/// A hand that rests gives a surface that rests: depth and outline are averaged over the frames in
/// which a place of the picture has not changed.
///
/// Whether it has is asked of all pixels of a small cell together. One pixel's depth scatters by a
/// millimetre or two, and its outline flickers by a pixel; the mean over a cell scatters by a third
/// of that:
///
///     shift = max( |mean depth now - average|,  width of what changed along the outline )
///     share of this frame = 1 / frames at rest ... 1        from settings.rests to settings.moves
///
/// so that of what moves the present frame alone counts. A cell also takes the share of its
/// neighbours that move. What creeps, as a finger that presses does, shifts by less than that in a
/// frame; it is told by all cells around together, whose shift scatters by a fifth of one cell's:
///
///     shift = max( |sum of (depth now - average)| / pixels,  |d| )        from creeps to flows
///     d = (sum of n n^T over the outline's pixels)^-1 (sum of n over those that came - those gone)
///
/// with n the outline's normal, outward in the picture,
///
/// so that the average lags by less than settings.flows.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/pixel_box.h"
#include "palpable/common/geometry/rigid.h"

#include <cstddef>
#include <vector>

namespace palpable {

struct RestFilterSettings {
  double rests = 0.0010;   ///< m: what has shifted by less has not moved
  double moves = 0.0020;   ///< m: what has shifted by more is where it is seen now
  double creeps = 0.0003;  ///< m: `rests` of all cells around together,
  double flows = 0.0006;   ///< m: and `moves`
  int most_frames = 32;    ///< that are averaged; 1: none
  int cell_px = 12;        ///< side of a cell
  /// A pixel whose depth differs by more sigmas from its average shows something else now.
  double sigmas = 4;
};

/// For a camera that stands: what another one sees of a resting thing moves through its picture,
/// and is passed on as it is.
class RestFilter {
 public:
  /// @throws ContractViolation for settings out of their range
  explicit RestFilter(const RestFilterSettings& settings = {});

  /// @param depth, shows  of this frame (ObjectSurface::build); `shows` of the depth's size
  /// @param box           holds all that presses and is looked at
  /// @param noise         sigma of one pixel's depth at 1 m, m; it grows as Z^2
  void add(const DepthImage& depth, const MaskImage& shows, const PixelBox& box,
           const PinholeCamera& camera, const Rigid3& camera_from_body, double noise);

  /// The frame, averaged, in and up to 16 px around the box; elsewhere anything. Valid until the
  /// next add().
  [[nodiscard]] const DepthImage& depth() const { return depth_; }
  [[nodiscard]] const MaskImage& shows() const { return shows_; }
  /// 1 where a thing is, 0 beside it, between them where its outline flickers; of the depth's size.
  [[nodiscard]] const Image<float>& presence() const { return presence_; }
  /// All that is shown as a thing lies in here.
  [[nodiscard]] const PixelBox& box() const { return box_; }
  /// Frames that count at a pixel of the box, 1 .. most_frames.
  [[nodiscard]] float frames_at(int x, int y) const { return cell_at(x, y).frames; }

 private:
  // What the pixels at an outline tell of how it shifted, px.
  struct Outline {
    float xx = 0, xy = 0, yy = 0;  // sum of n n^T
    float x = 0, y = 0;            // of n at those that came, less those that went
  };
  struct Cell {
    float frames = 0;  // that count; 0: nothing is known
    float share = 1;   // of this frame
    // Of this frame: pixels of a thing, those that were one before, the sum of their depths less
    // the average, of their depths, pixels that came or went, pixels at an outline.
    float now = 0, both = 0, apart = 0, depth = 0, changed = 0, edge = 0;
    Outline outline = {};
  };
  [[nodiscard]] Cell* row_of_cells(int y) {
    return cells_.data() + static_cast<std::size_t>(y / settings_.cell_px) * cells_across_;
  }
  [[nodiscard]] const Cell& cell_at(int x, int y) const {
    return cells_[static_cast<std::size_t>(y / settings_.cell_px) * cells_across_ +
                  static_cast<std::size_t>(x / settings_.cell_px)];
  }
  void start(const DepthImage& depth, const MaskImage& shows, const PixelBox& box,
             const Rigid3& camera_from_body);
  void sum_up(const DepthImage& depth, const MaskImage& shows);
  void add_outline(const MaskImage& shows, int x, int y, float came, Outline& outline) const;
  [[nodiscard]] float shift_around(std::ptrdiff_t column, std::ptrdiff_t row, float fx_px) const;
  void find_shares(const PinholeCamera& camera);
  void average(const DepthImage& depth, const MaskImage& shows, float gate_at_1m);

  RestFilterSettings settings_;
  Rigid3 camera_from_body_ = Rigid3::Identity();
  PixelBox box_;
  PixelBox remembered_;  // holds all pixels at which presence_ is not 0
  DepthImage depth_;
  MaskImage shows_;
  Image<float> average_, presence_;  // m; 1 where a thing is, 0 beside it
  std::size_t cells_across_ = 0;
  std::vector<int> cell_of_column_;
  std::vector<Cell> cells_;   // of the whole picture
  std::vector<float> moved_;  // per cell: 0 rests .. 1 moves
};

}  // namespace palpable

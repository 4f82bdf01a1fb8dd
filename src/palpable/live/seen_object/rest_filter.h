/// @file
/// Averages depth and outline over the frames in which a part of the picture has not changed, so
/// that a resting hand gives a resting surface.
///
/// Change is measured for all pixels of a small cell together. The depth of one pixel scatters by a
/// millimetre or two, and an outline flickers by a pixel; the mean over a cell scatters by a third
/// of that. The weight of the present frame in a cell's average grows with the cell's shift:
///
///     shift = max( |mean depth now - average|,  width of the changed strip along the outline )
///     weight = 1 / (frames at rest) for shift <= settings.rests,  1 for shift >= settings.moves
///
/// so that a moving thing is shown as in the present frame alone. A cell takes the largest weight
/// of its neighbours. A thing that creeps, such as a finger that presses, shifts by less than that
/// in a frame. Therefore a second shift is taken over the 5 x 5 cells around. It scatters by a
/// fifth of one cell's, and makes the weight grow between settings.creeps and settings.flows:
///
///     shift = max( |sum of (depth now - average)| / pixels,  |d| )
///     d = (sum of n n^T over the outline's pixels)^-1 (sum of n over pixels that came - that went)
///
/// with n the outline's normal, outward in the picture, and d the outline's displacement. So the
/// average lags behind by less than settings.flows.
#pragma once

#include "palpable/common/geometry/camera.h"
#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/pixel_box.h"
#include "palpable/common/geometry/rigid.h"

#include <cstddef>
#include <vector>

namespace palpable {

struct RestFilterSettings {
  double rests = 0.0010;   ///< m: a cell that shifts by less is averaged over most_frames
  double moves = 0.0020;   ///< m: a cell that shifts by more is shown as in this frame
  double creeps = 0.0003;  ///< m: as `rests`, for the shift over the 5 x 5 cells around
  double flows = 0.0006;   ///< m: as `moves`, likewise; the largest lag of the average
  int most_frames = 32;    ///< over which is averaged; 1: no averaging
  int cell_px = 12;        ///< side of a cell
  /// Standard deviations of the depth: a pixel that differs by more from its average shows another
  /// surface now, and its average begins anew.
  double sigmas = 4;
};

/// The filter of a camera that stands. The picture of a resting thing moves through a moving
/// camera's picture; frames of such a camera are passed on unchanged.
class RestFilter {
 public:
  /// @throws ContractViolation for settings out of their range
  explicit RestFilter(const RestFilterSettings& settings = {});

  /// Adds a frame.
  /// @param depth, shows  of this frame (ObjectSurface::build); `shows` of the depth's size
  /// @param box           holds all pressers that are to be filtered
  /// @param noise         sigma of one pixel's depth at 1 m, m; it grows as Z^2
  /// @param coverage      share of each pixel that shows a presser (outline_search.h), valid in the
  ///                      box; null: 1 at pressers, 0 elsewhere
  void add(const DepthImage& depth, const MaskImage& shows, const PixelBox& box,
           const PinholeCamera& camera, const Rigid3& camera_from_body, double noise,
           const Image<float>* coverage = nullptr);

  /// The averaged frame in box() and up to 16 px around it; undefined elsewhere. Valid until the
  /// next add().
  [[nodiscard]] const DepthImage& depth() const { return depth_; }
  [[nodiscard]] const MaskImage& shows() const { return shows_; }
  /// The share of a pixel that showed a thing, averaged: 1 inside, 0 beside it, between them where
  /// its outline flickers or crosses the pixel. Of the depth's size.
  [[nodiscard]] const Image<float>& presence() const { return presence_; }
  /// Holds all pixels that shows() calls a presser.
  [[nodiscard]] const PixelBox& box() const { return box_; }
  /// The number of frames averaged at a pixel of the box, 1 .. most_frames.
  [[nodiscard]] float frames_at(int x, int y) const { return cell_at(x, y).frames; }

 private:
  // Normal equations of an outline's displacement d, px: (sum of n n^T) d = (x, y).
  struct Outline {
    float xx = 0, xy = 0, yy = 0;  // sum of n n^T
    float x = 0, y = 0;            // sum of n over pixels that came, less that over those that went
  };
  struct Cell {
    float frames = 0;   // averaged; 0: none
    float share = 1;    // weight of this frame
    float now = 0;      // pixels of a thing in this frame
    float both = 0;     // pixels of a thing now and before
    float apart = 0;    // m, sum of depth - average over `both`
    float depth = 0;    // m, sum of depths over `now`
    float changed = 0;  // pixels that came or went
    float edge = 0;     // pixels at an outline
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
  void average(const DepthImage& depth, const MaskImage& shows, const PixelBox& box,
               const Image<float>* coverage, float gate_at_1m);

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

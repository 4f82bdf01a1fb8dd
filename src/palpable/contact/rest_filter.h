/// @file
/// A hand that rests gives a surface that rests: depth and outline of each thing are averaged over
/// the frames in which it has not moved.
///
/// Whether a thing moves is asked of all its pixels together. One pixel's depth scatters by a
/// millimetre or two, and its outline flickers by a pixel; the mean of some thousand pixels and the
/// middle of the outline stay within a tenth of that. So a motion of a fraction of a millimetre is
/// seen at once, and then the present frame counts alone:
///
///     shift = mean depth and middle of the thing, now against the average
///     share of this frame = 1 / frames at rest ... 1        from settings.rests to settings.moves
///
/// The average lags behind a thing that moves by less than settings.moves.
#pragma once

#include "palpable/contact/part_labels.h"
#include "palpable/geometry/camera.h"
#include "palpable/geometry/image.h"
#include "palpable/geometry/pixel_box.h"
#include "palpable/geometry/rigid.h"

#include <cstdint>
#include <vector>

namespace palpable {

struct RestFilterSettings {
  double rests = 0.0003;  ///< m: a thing that has shifted by less has not moved
  double moves = 0.0010;  ///< m: one that has shifted by more is where it is seen now
  int most_frames = 16;   ///< that are averaged; 1: none
  /// A pixel whose depth differs by more sigmas from its average shows something else now.
  double sigmas = 4;
};

/// For a camera that stands: what another one sees of a resting thing moves through its picture, and
/// is passed on as it is.
class RestFilter {
 public:
  explicit RestFilter(const RestFilterSettings& settings = {}) : settings_(settings) {}

  /// @param depth, shows  of this frame (ObjectSurface::build); `shows` of the depth's size
  /// @param parts         of this frame; what presses lies in their box
  /// @param noise         sigma of one pixel's depth at 1 m, m; it grows as Z^2
  void add(const DepthImage& depth, const MaskImage& shows, const PartLabels& parts,
           const PinholeCamera& camera, const Rigid3& camera_from_body, double noise);

  /// The frame, averaged, in and up to 16 px around the box; elsewhere anything. Valid until the
  /// next add().
  [[nodiscard]] const DepthImage& depth() const { return depth_; }
  [[nodiscard]] const MaskImage& shows() const { return shows_; }
  /// All that is shown as a thing lies in here.
  [[nodiscard]] const PixelBox& box() const { return box_; }
  /// Frames that count in the thing that is shown at a pixel of the box, 1 .. most_frames.
  [[nodiscard]] float frames_at(int x, int y) const {
    const int part = part_(x, y);
    return part >= 0 && part < static_cast<int>(parts_.size())
               ? parts_[static_cast<std::size_t>(part)].frames
               : 1;
  }

 private:
  struct Part {
    double pixels = 0, x = 0, y = 0, z = 0;  // sums over its pixels in this frame
    double both = 0, apart = 0;  // pixels that were there before, and the sum of now - average
    int was = PartLabels::kNone;  // of the frame before
    float frames = 1, share = 1;
  };
  // A part as it was, of the average's pixels.
  struct FormerPart {
    double pixels = 0, x = 0, y = 0;
    float frames = 1, share = 1;  // share: of the frame, for its pixels that are not there now
  };

  void start(const DepthImage& depth, const MaskImage& shows, const PartLabels& parts,
             const Rigid3& camera_from_body);
  void sum_up(const DepthImage& depth, const PartLabels& parts);
  void find_shares(const PinholeCamera& camera);
  void average(const DepthImage& depth, const MaskImage& shows, const PartLabels& parts,
               float gate_at_1m);

  RestFilterSettings settings_;
  Rigid3 camera_from_body_ = Rigid3::Identity();
  PixelBox box_;
  DepthImage depth_;
  MaskImage shows_;
  Image<float> average_, presence_;  // m; 1 where a thing is, 0 beside it
  Image<std::int16_t> part_;         // the part of the frame before that was there
  std::vector<Part> parts_;
  std::vector<FormerPart> before_;
  std::vector<int> overlaps_;  // pixels of part i that were of part k, at i * former parts + k
};

/// The smallest box that holds both.
[[nodiscard]] PixelBox united(const PixelBox& a, const PixelBox& b);

}  // namespace palpable

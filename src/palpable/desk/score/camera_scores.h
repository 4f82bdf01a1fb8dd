/// @file
/// What is known of the camera: the error of its path with respect to the true one, how steadily
/// the drawn body keeps its position in the real world while the camera moves, and whether the loss
/// of a rig's alignment is detected and corrected.
///
///   n  pairs of poses that match in time
#pragma once

#include "palpable/common/geometry/rigid.h"

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace palpable {

/// A true and a found world_from_camera and the time of the true one.
struct PosePair {
  double time = 0;  ///< s
  Rigid3 truth = Rigid3::Identity();
  Rigid3 found = Rigid3::Identity();
};

/// Pairs each true pose with the found pose nearest in time, in the order of the true poses.
/// @param truth, found  times strictly increasing
/// @param largest_gap   s; true poses without a found pose within it are skipped
[[nodiscard]] std::vector<PosePair> match_in_time(std::span<const StampedPose> truth,
                                                  std::span<const StampedPose> found,
                                                  double largest_gap);

/// The rigid transform that brings the found positions nearest to the true ones (Umeyama 1991,
/// without scale, by the singular values of the covariance):
///
///     argmin over rotations R and t of  sum_i |t_true_i - (R t_found_i + t)|^2
///
/// If the positions lie on a line or at a point, the rotation is not unique; any minimiser is
/// returned.
/// @param pairs  at least one
[[nodiscard]] Rigid3 align_positions(std::span<const PosePair> pairs);

struct TrajectoryScore {
  int poses = 0;  ///< number of pairs
  /// Absolute trajectory error, m: root mean square of |t_true - A t_found| with the alignment A
  /// above (Sturm et al., IROS 2012).
  double ate = 0;
  /// Relative pose error over `span` seconds. With the motions T_i = X_i^-1 X_j between each pose i
  /// and the first pose j at least `span` later, it is the root mean square over i of the length of
  /// the translation of T_true_i^-1 T_found_i, m, and of its rotation angle, rad. It needs no
  /// alignment. Nothing when the path is shorter than `span`.
  std::optional<double> rpe;
  std::optional<double> rpe_angle;
};

/// @param pairs  at least one, times increasing
/// @param span   s, > 0; a pose j later than 1.5 times the span is not used
[[nodiscard]] TrajectoryScore score_trajectory(std::span<const PosePair> pairs, double span = 1.0);

/// Spread of the position at which the body's origin was drawn, in the real world:
///
///     p_n = world_from_camera_true(n) * camera_from_body_drawn(n) * 0
///     jitter = sqrt( mean over n of |p_n - mean p|^2 )
///
/// Slow drift and fast trembling both count; a body drawn at a wrong but constant position has no
/// jitter.
class AnchorScorer {
 public:
  void add(const Rigid3& true_world_from_camera, const Rigid3& drawn_camera_from_body);

  /// m; nothing before the first frame.
  [[nodiscard]] std::optional<double> jitter() const;

 private:
  int frames_ = 0;
  Eigen::Vector3d mean_ = Eigen::Vector3d::Zero();
  double squares_ = 0;  ///< sum of |p - mean|^2, updated as in Welford 1962
};

/// Truth of one frame: how much lower the right image lies than the calibration says, in rows of
/// the full-size picture.
struct TrueRowOffset {
  int frame = 0;
  double offset_px = 0;
  bool step = false;  ///< the offset jumped in this frame
};

/// From this frame on the right image was moved up by this number of rows of the full-size picture,
/// in addition to the rectification by the calibration.
struct RowCorrection {
  int frame = 0;
  double correction_px = 0;
};

/// The largest |offset - correction|, px, over all frames except a step's own and the `settle`
/// frames after it. All pixels of a frame have the same offset, so this is also the largest median
/// row error of a frame. The correction is 0 before the first one; each holds until the next.
/// Nothing when no frame is left.
/// @param truth, corrections  frames strictly increasing
/// @param settle              >= 0, frames: the frame rate, for one second
/// @param processed           one entry per frame of `truth`; 0: the error of this frame does not
///                            count, but a step in it does. Empty: all frames count
/// @throws ContractViolation for a negative `settle` or another length of `processed`
[[nodiscard]] std::optional<double> largest_row_error(std::span<const TrueRowOffset> truth,
                                                      std::span<const RowCorrection> corrections,
                                                      int settle,
                                                      std::span<const std::uint8_t> processed = {});

}  // namespace palpable

/// @file
/// Jumps of the drawn surface that no motion in the real world explains.
///
///   V  vertices of the drawn body
#pragma once

#include "palpable/common/geometry/capsule.h"
#include "palpable/common/geometry/rigid.h"

#include <Eigen/Core>

#include <deque>
#include <optional>
#include <vector>

namespace palpable {

/// One frame of a run: the drawn surface, and the truth at that instant.
struct PopFrame {
  int number = 0;
  Eigen::Matrix3Xd surface;                       ///< (3 x V) m, as drawn, body frame
  Rigid3 camera_from_body = Rigid3::Identity();   ///< as drawn
  Rigid3 world_from_camera = Rigid3::Identity();  ///< true
  std::vector<Capsule> hand;                      ///< true, camera frame of this frame
};

struct Pop {
  double size = 0;  ///< m, >= 0
  int frame = -1;   ///< the later of the two frames
};

/// m; pops larger than this are counted.
inline constexpr double kCountedPop = 0.004;

/// Finds the largest pop of a run and counts the large ones. The pop between a frame n and its
/// predecessor n-1 in the run is
///
///     pop(n) = max over vertices |x_n - x_{n-1}|  -  max(m_n, m_{n-1}, m_{n-2}),   at least 0,
///
/// where m_n is the motion of the hand: the largest displacement, in the world frame, of an end of
/// a capsule that is within 20 mm of the drawn body in either frame, or 0 when there is none. A
/// deformed surface moves no farther than the obstacle that presses it; the two earlier motions
/// allow for a response that is up to two frames late. x is in body coordinates, so that errors of
/// the body's pose do not count here (anchor_score.h scores them).
///
/// If the run skipped frames between the two, its last picture stayed on the screen in the
/// meantime: the jump is visible all the same, and m_n is the motion between the two frames. Frames
/// in which a near hand has another number of capsules than in the frame before are not compared.
class PopScorer {
 public:
  /// @throws ContractViolation when V changes
  void add(PopFrame frame);

  /// The largest pop so far; nothing when no two frames could be compared.
  [[nodiscard]] const std::optional<Pop>& largest() const { return largest_; }
  /// Number of pops larger than kCountedPop; nothing when no two frames could be compared.
  [[nodiscard]] std::optional<int> counted() const {
    if (!largest_) return std::nullopt;
    return counted_;
  }

 private:
  std::optional<PopFrame> last_;
  std::deque<double> moved_;  ///< m_{n-1}, m_{n-2}, in this order
  std::optional<Pop> largest_;
  int counted_ = 0;
};

}  // namespace palpable

/// @file
/// Jumps of the drawn surface that nothing in the real world explains.
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

/// One frame of a run: what was drawn, and the truth of that moment.
struct PopFrame {
  int number = 0;
  Eigen::Matrix3Xd surface;                       ///< (3 x V) m, as drawn, body frame
  Rigid3 camera_from_body = Rigid3::Identity();   ///< where it was drawn
  Rigid3 world_from_camera = Rigid3::Identity();  ///< true
  std::vector<Capsule> hand;                      ///< true, camera frame of this frame
};

struct Pop {
  double size = 0;  ///< m, >= 0
  int frame = -1;   ///< the later of the two frames
};

/// m: a pop that is larger than this is counted.
inline constexpr double kCountedPop = 0.004;

/// Finds the largest pop of a run, and counts the large ones. Between two frames of the run, n and
/// the one before it, n-1,
///
///     pop(n) = max over vertices |x_n - x_{n-1}|  -  max(m_n, m_{n-1}, m_{n-2}),   at least 0,
///
/// where m_n is how far the hand moved: the longest way, in the world, of the end of a capsule that
/// is within 20 mm of the drawn body in either frame; 0 when none is. A surface that gives way
/// moves no farther than what presses it; the two earlier steps allow an answer that comes up to
/// two frames late. Body coordinates leave out where the body is drawn (anchor_score.h).
///
/// Where frames were left out between the two, what the run showed before stayed on the screen: the
/// jump is seen all the same, and the hand's way is that from the one to the other. Frames in which
/// a near hand has another number of capsules than before are not compared.
class PopScorer {
 public:
  /// @throws ContractViolation when V changes
  void add(PopFrame frame);

  /// The largest so far; nothing when no two frames could be compared.
  [[nodiscard]] const std::optional<Pop>& largest() const { return largest_; }
  /// How many were larger than kCountedPop; nothing when no two frames could be compared.
  [[nodiscard]] std::optional<int> counted() const {
    if (!largest_) return std::nullopt;
    return counted_;
  }

 private:
  std::optional<PopFrame> last_;
  std::deque<double> moved_;  ///< m_{n-1}, m_{n-2}: the later first
  std::optional<Pop> largest_;
  int counted_ = 0;
};

}  // namespace palpable

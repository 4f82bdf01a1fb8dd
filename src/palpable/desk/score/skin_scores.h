/// @file
/// The skin as it is drawn: how deep a real hand reaches into it, which should have deformed it;
/// jumps that no motion in the real world explains; whether it is the skin of the true body, and
/// the error of the position and rotation at which it is drawn.
///
///   V  vertices of the drawn body     N  vertices of the body's skin
#pragma once

#include "palpable/common/geometry/capsule.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/common/geometry/surface_mesh.h"

#include <Eigen/Core>

#include <deque>
#include <optional>
#include <span>
#include <vector>

namespace palpable {

/// Distance of x to the capsule's surface, m, negative inside: the smallest |x - c| - r over the
/// capsule's balls (middle c, radius r). Exact, closed form.
[[nodiscard]] double distance_to(const Capsule& capsule, const Eigen::Vector3d& x);

/// m, largest distance of neighbouring samples of a triangle.
inline constexpr double kSampleSpacing = 0.002;

/// Searches the deepest sample triangle by triangle.
///
/// A triangle is split at the middles of its edges, recursively, until the edges of the parts are
/// at most kSampleSpacing long; the samples are the corners of the parts. So a pencil's tip between
/// the vertices of a triangle is found, too. An edge is split into at most 4096 parts, which bounds
/// the cost for huge triangles in a wrong file. Parts that cannot hold a sample deeper than the
/// deepest one so far are skipped.
class DeepestSample {
 public:
  /// @param capsule  must outlive this object
  /// @param from     m; only deeper samples are found. A negative value also finds samples outside
  ///                 the capsule that are this near to it
  DeepestSample(const Capsule& capsule, double from);

  /// @return whether the triangle holds a deeper sample than all triangles before it
  bool look_at(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c);

  [[nodiscard]] double depth() const { return depth_; }  ///< m; `from` until a sample is found
  [[nodiscard]] const Eigen::Vector3d& point() const {
    return point_;
  }  ///< m; valid once a sample is found

 private:
  void halve(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
             int halvings);
  [[nodiscard]] bool misses_box(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                const Eigen::Vector3d& c) const;

  const Capsule& capsule_;
  Eigen::Array3d low_, high_;
  double depth_;
  Eigen::Vector3d point_ = Eigen::Vector3d::Zero();
};

/// Depth of the deepest sample of the triangles (DeepestSample) inside the capsules, m; 0 when
/// no sample is inside.
/// @param surface  m, in the same frame as the capsules
[[nodiscard]] double deepest_penetration(const SurfaceMesh& surface,
                                         std::span<const Capsule> capsules);

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
/// the body's pose do not count here (AnchorScorer scores them).
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

/// Mean distance between two skins, m: the area-weighted mean distance of the vertices of one skin
/// to the nearest point of the other. The larger value of the two directions is returned, so that a
/// part missing in either skin counts.
/// @param a, b  m, in the same frame, each with at least one triangle
[[nodiscard]] double skin_offset(const SurfaceMesh& a, const SurfaceMesh& b);

/// The largest distance, m, of a vertex of the body at rest between its true pose and the drawn
/// pose, from translation and rotation together. Deformation by touches is not included.
/// @param rest          (3 x N) m, body frame, N > 0
/// @param truth, drawn  camera_from_body of one frame
/// @throws ContractViolation without a vertex
[[nodiscard]] double placement_error(const Eigen::Matrix3Xd& rest, const Rigid3& truth,
                                     const Rigid3& drawn);

}  // namespace palpable

/// @file
/// Exact capsules as obstacles, as in a game or with a haptic device instead of a camera.
#pragma once

#include "palpable/common/contact/obstacles.h"
#include "palpable/common/geometry/capsule.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <span>
#include <vector>

namespace palpable {

/// The distance to the nearest of some capsules.
class CapsuleObstacles : public Obstacles {
 public:
  /// Keeps its memory.
  /// @param capsules  body frame
  /// @param things    which thing each capsule belongs to, SurfaceGap::thing; empty: not known
  void set(std::span<const Capsule> capsules, std::span<const int> things = {});

  void find_gaps(std::span<const Eigen::Vector3f> places,
                 std::span<SurfaceGap> gaps) const override;
  [[nodiscard]] bool may_be_within(const Eigen::Vector3f& place, float reach) const override;
  [[nodiscard]] float depth_at(const Eigen::Vector3f& place) const override;
  [[nodiscard]] bool has_exact_parts() const override { return true; }
  void add_sharp_parts(const Eigen::AlignedBox3f& box, float radius,
                       std::vector<SharpPart>& parts) const override;

 private:
  [[nodiscard]] SurfaceGap gap_of(const Eigen::Vector3f& place) const;

  std::vector<CapsuleField> fields_;
  std::vector<int> things_;       // of the capsules, or empty
  std::vector<SharpPart> parts_;  // the capsules themselves
  std::vector<Eigen::AlignedBox3f> boxes_;
  Eigen::AlignedBox3f box_;  // of all capsules
};

}  // namespace palpable

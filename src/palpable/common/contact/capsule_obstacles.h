/// @file
/// Exact capsules as obstacles, as in a game or with a haptic device instead of a camera.
#pragma once

#include "palpable/common/contact/obstacles.h"
#include "palpable/common/geometry/capsule.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <memory>
#include <optional>
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
  /// What friction needs to know of the capsules that were set; set() forgets it. Without it they
  /// rub nothing. Keeps its memory.
  /// @param friction  Coulomb's coefficient of each capsule (SurfaceGap::friction)
  /// @param before    the capsules of the frame before, body frame
  /// @param now       as many: which of the present ones each has become; -1: it is gone
  void set_friction(std::span<const float> friction, std::span<const Capsule> before,
                    std::span<const int> now);

  void find_gaps(std::span<const Eigen::Vector3f> places,
                 std::span<SurfaceGap> gaps) const override;
  [[nodiscard]] bool may_be_within(const Eigen::Vector3f& place, float reach) const override;
  [[nodiscard]] float depth_at(const Eigen::Vector3f& place) const override;
  [[nodiscard]] bool has_exact_parts() const override { return true; }
  void add_sharp_parts(const Eigen::AlignedBox3f& box, float radius,
                       std::vector<SharpPart>& parts) const override;
  /// A material point moves with the end a of its capsule, and turns with the axis on the shortest
  /// way: capsules do not spin about their axes.
  [[nodiscard]] float largest_friction(float of_body) const override;
  [[nodiscard]] std::optional<MaterialPoint> carried(const MaterialPoint& before) const override;
  [[nodiscard]] std::optional<Eigen::Vector3f> way_of(const MaterialPoint& now) const override;
  [[nodiscard]] const Obstacles* on_the_way(float done) const override;
  [[nodiscard]] float largest_way() const override;

 private:
  [[nodiscard]] SurfaceGap gap_of(const Eigen::Vector3f& place) const;
  void set_motion(std::span<const float> friction, std::span<const Capsule> before,
                  std::span<const int> now);
  void make_room_on_the_way();

  std::vector<CapsuleField> fields_;
  std::vector<int> things_;       // of the capsules, or empty
  std::vector<SharpPart> parts_;  // the capsules themselves
  std::vector<Eigen::AlignedBox3f> boxes_;
  Eigen::AlignedBox3f box_;  // of all capsules
  // Of friction; empty without it.
  std::vector<float> friction_;          // of the capsules
  std::vector<Capsule> capsules_;        // the capsules, and
  std::vector<Capsule> before_;          // those of the frame before;
  std::vector<int> now_of_, before_of_;  // of each of the latter, and of the former; -1: none
  // Of on_the_way(): the capsules, and obstacles made of them, which have no such themselves.
  mutable std::vector<Capsule> between_;
  std::unique_ptr<CapsuleObstacles> on_the_way_;
};

}  // namespace palpable

/// @file
/// Where a body on the desk can be pressed, and how a hand has to be held for it.
///
/// Desk frame (desk_body.h), metres.
#pragma once

#include "palpable/synth/desk_body.h"
#include "palpable/synth/hand_path.h"

#include <optional>
#include <vector>

namespace palpable {

/// A place of the body that a press aims at.
struct PressTarget {
  Eigen::Vector3d x = Eigen::Vector3d::Zero();           ///< on the surface
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit, into the body
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();     ///< unit, out of the body
  int site = -1;                                         ///< the nearest
  bool between = false;                                  ///< lies between two sites
};

/// What is asked of a press.
struct PressRules {
  /// Cosines between the press and the way to the eye: the touching surface faces the eye when the
  /// press goes towards it.
  double least_facing = 0;
  double most_facing = 1;
  double most_x = 1;            ///< of the direction: below 0 the press comes from the right
  bool seen = true;             ///< the hand must not hide what it touches with
  double near = 0.026;          ///< m: what belongs to the pressed place; beyond, nothing may touch
  double clearance = 0.004;     ///< m between the hand and the body beyond that
  double eye_clearance = 0.10;  ///< m between the arm and the camera
  double approach = 0.045;      ///< m of straight way before the first touch
};

/// A way to press a target.
struct PressPosture {
  PressTarget target;
  Eigen::Vector3d touch = Eigen::Vector3d::Zero();  ///< the tip's middle at the first touch
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  double view_angle = 0;  ///< rad, between the touching surface's normal and the ray to the eye
};

/// The body as it stands and the eye that looks at it.
class PressSearch {
 public:
  /// @param points  (3 x P) of the body's surface, desk frame: its vertices, or closer together
  PressSearch(Eigen::Matrix3Xd points, const Eigen::Vector3d& eye);

  [[nodiscard]] const Eigen::Matrix3Xd& points() const { return points_; }
  [[nodiscard]] const Eigen::Vector3d& eye() const { return eye_; }

  /// How well the camera sees a press there; negative when it breaks the rules.
  [[nodiscard]] double score(const PressTarget& target, const PressRules& rules) const;

  /// The hand's best posture for the target, if there is one: off the desk, clear of the body
  /// outside the pressed place when it is `depth` deep, with a free way to it.
  [[nodiscard]] std::optional<PressPosture> posture(const PressTarget& target, double depth,
                                                    const HandTool& tool, const ArmSide& arm,
                                                    const PressRules& rules) const;

  /// The tip's middle where the hand, moved along `direction`, first touches the body: looked for
  /// from 20 mm before x to 4 mm behind it.
  [[nodiscard]] std::optional<Eigen::Vector3d> first_touch(const Eigen::Vector3d& x,
                                                           const Eigen::Vector3d& direction,
                                                           const Eigen::Quaterniond& turn,
                                                           const HandTool& tool,
                                                           const ArmSide& arm) const;

 private:
  Eigen::Matrix3Xd points_, some_;
  Eigen::Vector3d eye_;
};

/// The lowest point of what capsules enclose, m above the desk; infinite for none.
[[nodiscard]] double lowest_point(std::span<const Capsule> capsules);

}  // namespace palpable

/// @file
/// Where a body on the desk can be pressed, and how a hand has to be held for it.
///
/// Desk frame (desk_body.h), metres.
#pragma once

#include "palpable/desk/script/desk_body.h"
#include "palpable/desk/script/hand_path.h"

#include <optional>
#include <span>
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

/// What one kind of sequence demands of its presses.
struct PressRules {
  /// Bounds of the cosine between the press and the direction to the eye. At 1 the finger moves
  /// straight towards the eye and shows it the touching surface; at -1 it moves away from the eye
  /// and hides what it touches.
  double least_facing = 0;
  double most_facing = 1;
  double most_x = 1;    ///< bound of the press direction's x: negative for presses from the right
  bool seen = true;     ///< the hand must not hide the place where it touches
  double near = 0.026;  ///< m round the target in which the hand may touch the body
  double clearance = 0.004;     ///< m between the hand and the rest of the body
  double eye_clearance = 0.10;  ///< m between the arm and the camera
  double approach = 0.045;      ///< m that the hand moves straight before it touches
};

/// A target with its score.
struct RankedTarget {
  PressTarget target;
  double score;
};

/// How a hand is held to press a target.
struct PressPosture {
  PressTarget target;
  Eigen::Vector3d touch = Eigen::Vector3d::Zero();  ///< middle of the tip at the first touch
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();  ///< desk from wrist
  double view_angle = 0;  ///< rad, between the touching surface's normal and the ray to the eye
};

/// Finds postures for one body that stands on the desk and one eye that looks at it.
class PressSearch {
 public:
  /// @param points  (3 x P) of the body's surface, desk frame: its vertices, or denser samples
  PressSearch(Eigen::Matrix3Xd points, const Eigen::Vector3d& eye);

  [[nodiscard]] const Eigen::Matrix3Xd& points() const { return points_; }
  [[nodiscard]] const Eigen::Vector3d& eye() const { return eye_; }

  /// How well the camera sees a press there; negative when the press breaks the rules.
  [[nodiscard]] double score(const PressTarget& target, const PressRules& rules) const;

  /// The targets that keep the rules, best first; equal ones in their order.
  [[nodiscard]] std::vector<RankedTarget> ranked(std::span<const PressTarget> targets,
                                                 const PressRules& rules) const;

  /// The best of the postures that PressSearch tries: in it the hand stays above the desk, away
  /// from the camera and, when it has pressed `depth` deep, away from the body outside of the
  /// target's surroundings (PressRules::near). None when every one of them breaks a rule.
  [[nodiscard]] std::optional<PressPosture> posture(const PressTarget& target, double depth,
                                                    const HandTool& tool, const ArmSide& arm,
                                                    const PressRules& rules) const;

  /// The middle of the tip where the hand, moved along `direction`, first touches the body.
  /// Searched from 20 mm before x to 4 mm behind it; none when the hand touches at the start
  /// already, or does not touch at the end.
  [[nodiscard]] std::optional<Eigen::Vector3d> first_touch(const Eigen::Vector3d& x,
                                                           const Eigen::Vector3d& direction,
                                                           const Eigen::Quaterniond& turn,
                                                           const HandTool& tool,
                                                           const ArmSide& arm) const;

 private:
  /// Whether the hand lies between the eye and the place x where it touches.
  [[nodiscard]] bool hides(std::span<const Capsule> hand, const Eigen::Vector3d& x) const;

  Eigen::Matrix3Xd points_;
  Eigen::Matrix3Xd some_;  // about 700 of them: quicker, and enough for clearances
  Eigen::Vector3d eye_;
};

/// Height of the lowest point of the capsules above the desk, m; infinite without capsules.
[[nodiscard]] double lowest_point(std::span<const Capsule> capsules);

}  // namespace palpable

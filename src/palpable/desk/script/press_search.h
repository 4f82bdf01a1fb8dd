/// @file
/// Search for places where a body on the desk can be pressed, and for the postures of the hand.
///
/// Desk frame (desk_body.h), m.
#pragma once

#include "palpable/desk/script/desk_body.h"
#include "palpable/desk/script/hand_path.h"

#include <optional>
#include <span>
#include <vector>

namespace palpable {

/// A target of a press.
struct PressTarget {
  Eigen::Vector3d x = Eigen::Vector3d::Zero();           ///< on the surface
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit, into the body
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();     ///< unit, out of the body
  int site = -1;                                         ///< the nearest site
  bool between = false;                                  ///< whether it lies between two sites
};

/// Requirements of one kind of sequence on its presses.
struct PressRules {
  /// Bounds of the cosine between the press and the direction to the eye. At 1 the finger moves
  /// straight towards the eye and shows it the touching surface; at -1 it moves away from the eye
  /// and hides what it touches.
  double least_facing = 0;
  double most_facing = 1;
  /// Upper bound of the x of the press direction; negative for presses from the right.
  double most_x = 1;
  bool seen = true;             ///< whether the hand must not hide the place where it touches
  double near = 0.026;          ///< m, radius round the target in which the hand may touch
  double clearance = 0.004;     ///< m, smallest distance of the hand from the rest of the body
  double eye_clearance = 0.10;  ///< m, smallest distance of the arm from the camera
  double approach = 0.045;      ///< m, length of the straight approach before the touch
};

/// A target with its score.
struct RankedTarget {
  PressTarget target;
  double score;
};

/// The posture of a hand that presses a target.
struct PressPosture {
  PressTarget target;
  Eigen::Vector3d touch = Eigen::Vector3d::Zero();  ///< centre of the tip at the first touch
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();  ///< desk from wrist
  double view_angle = 0;  ///< rad, between the touching surface's normal and the ray to the eye
};

/// Finds postures for one body on the desk and one eye that looks at it.
class PressSearch {
 public:
  /// @param points  (3 x P) m, points of the body's surface, desk frame: vertices or denser samples
  PressSearch(Eigen::Matrix3Xd points, const Eigen::Vector3d& eye);

  [[nodiscard]] const Eigen::Matrix3Xd& points() const { return points_; }
  [[nodiscard]] const Eigen::Vector3d& eye() const { return eye_; }

  /// A score of how well the camera sees a press at a target; negative when it violates the rules.
  [[nodiscard]] double score(const PressTarget& target, const PressRules& rules) const;

  /// The targets that satisfy the rules, sorted by score; stable for equal scores.
  [[nodiscard]] std::vector<RankedTarget> ranked(std::span<const PressTarget> targets,
                                                 const PressRules& rules) const;

  /// The best of a fixed set of postures in which the hand stays above the desk, away from the
  /// camera and, at the full depth `depth`, away from the body except near the target
  /// (PressRules::near). Nothing when each of them violates a rule.
  [[nodiscard]] std::optional<PressPosture> posture(const PressTarget& target, double depth,
                                                    const HandTool& tool, const ArmSide& arm,
                                                    const PressRules& rules) const;

  /// The centre of the tip when the hand, moved along `direction`, first touches the body. The
  /// search range is from 20 mm before x to 4 mm behind it. Nothing when the hand touches already
  /// at its start or does not touch at its end.
  [[nodiscard]] std::optional<Eigen::Vector3d> first_touch(const Eigen::Vector3d& x,
                                                           const Eigen::Vector3d& direction,
                                                           const Eigen::Quaterniond& turn,
                                                           const HandTool& tool,
                                                           const ArmSide& arm) const;

 private:
  /// Whether the hand hides the place x, where it touches, from the eye.
  [[nodiscard]] bool hides(std::span<const Capsule> hand, const Eigen::Vector3d& x) const;

  Eigen::Matrix3Xd points_;
  Eigen::Matrix3Xd some_;  // about 700 of the points: faster, and accurate enough for clearances
  Eigen::Vector3d eye_;
};

/// Height of the lowest point of the capsules above the desk, m; infinite without capsules.
[[nodiscard]] double lowest_point(std::span<const Capsule> capsules);

}  // namespace palpable

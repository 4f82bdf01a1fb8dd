/// @file
/// Presses a body with tables of touch by a finger, anywhere on its skin. The finger is a capsule
/// of radius 8 mm that is pushed along the skin's inward normal.
#pragma once

#include "palpable/common/response/touchable_body.h"
#include "palpable/live/render/scene_renderer.h"
#include "palpable/live/session/scene.h"
#include "palpable/live/things/pressed_bodies.h"

#include <Eigen/Core>

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace palpable {

/// The body, the finger, and the result of contact between them.
class FingerPress {
 public:
  static constexpr double kRadius = 0.008;   ///< m, of the finger
  static constexpr double kDeepest = 0.010;  ///< m, largest push at level 1

  /// The position and direction of a press; body frame, body at rest.
  struct Place {
    Eigen::Vector3d point = Eigen::Vector3d::Zero();    ///< m, on the skin
    Eigen::Vector3d inwards = Eigen::Vector3d::Zero();  ///< unit
  };

  /// Begins at rest. @param body  one with tables of touch (TouchableBody::touch)
  explicit FingerPress(const std::shared_ptr<const TouchableBody>& body);

  /// The place that has moved to the position `at` of the deformed skin. @param at  m, body frame
  [[nodiscard]] Place place_at(const Eigen::Vector3d& at) const;

  /// Moves the finger so that its tip lies inwards of the place by push(): 0 at level 0, and at
  /// level 1 kDeepest, or a tenth of the body's height if that is less.
  void press(const Place& place, double level);
  /// Removes the finger.
  void rest();
  /// Whether the body has not yet reached equilibrium because of the step limit: another press() at
  /// the same place continues.
  [[nodiscard]] bool moving() const { return left_to_move_ > 0; }

  [[nodiscard]] double level() const { return level_; }
  [[nodiscard]] double force() const;              ///< N, norm of the sum over all touches
  [[nodiscard]] double push() const;               ///< m, displacement of the tip from the place
  [[nodiscard]] double largest_von_mises() const;  ///< Pa
  /// (6V) Pa, as SceneBody::cauchy.
  [[nodiscard]] const std::vector<float>& cauchy() const { return shown_.cauchy; }
  [[nodiscard]] const std::vector<float>& contact_pressure() const {
    return shown_.contact_pressure;
  }
  [[nodiscard]] const std::optional<StatedError>& stated_error() const {
    return shown_.stated_error;
  }

  /// What is drawn of the body. It points to arrays of this object, which the next press
  /// overwrites.
  [[nodiscard]] BodyLook look() const;
  /// Appends a row of dots along the finger, towards its tip. @param radius  m
  void finger_dots(float radius, std::vector<Dot>& dots) const;

 private:
  void advance(std::span<const Capsule> capsules);

  std::shared_ptr<const TouchableBody> body_;
  PressedBodies solver_;
  double deepest_;  // m, at level 1
  double scale_;    // Pa
  Eigen::Matrix3Xf normals_at_rest_;
  Place place_;
  double level_ = 0;
  double left_to_move_ = 0;  // m
  SceneBody shown_;
  std::vector<Touch> touches_;
};

}  // namespace palpable

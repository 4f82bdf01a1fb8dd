/// @file
/// A body with tables of touch that a finger presses, anywhere on its skin: a ball of 8 mm with a
/// round stick behind it, which is pushed along the skin's inward normal.
#pragma once

#include "palpable/common/response/touchable_body.h"
#include "palpable/live/render/scene_renderer.h"
#include "palpable/live/session/capsule_press.h"
#include "palpable/live/session/scene.h"

#include <Eigen/Core>

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace palpable {

class FingerPress {
 public:
  static constexpr double kRadius = 0.008;   ///< m, of the finger
  static constexpr double kDeepest = 0.010;  ///< m, at full level, of a body that is high enough

  /// Where a finger presses, body frame, at rest.
  struct Place {
    Eigen::Vector3d point = Eigen::Vector3d::Zero();    ///< m, on the skin
    Eigen::Vector3d inwards = Eigen::Vector3d::Zero();  ///< unit
  };

  /// @param body  with tables of touch (TouchableBody::touch); at rest to begin with
  explicit FingerPress(const std::shared_ptr<const TouchableBody>& body);

  /// The place that lies now where `at` is on the skin as it is shown. @param at  m, body frame
  [[nodiscard]] Place place_at(const Eigen::Vector3d& at) const;

  /// Pushes the finger so far beyond the place that at level 0 it touches it there, and at level 1
  /// by kDeepest, or a tenth of the body's height if that is less.
  void press(const Place& place, double level);
  /// Takes it away.
  void rest();
  /// The state is not there yet: another press() at the same place goes on.
  [[nodiscard]] bool moving() const { return left_to_move_ > 0; }

  [[nodiscard]] double level() const { return level_; }
  [[nodiscard]] double force() const;              ///< N, of all touches together
  [[nodiscard]] double push() const;               ///< m, of the finger beyond the place
  [[nodiscard]] double largest_von_mises() const;  ///< Pa
  /// (6V) Pa, as SceneBody::cauchy.
  [[nodiscard]] const std::vector<float>& cauchy() const { return shown_.cauchy; }
  [[nodiscard]] const std::vector<float>& contact_pressure() const {
    return shown_.contact_pressure;
  }
  [[nodiscard]] const std::optional<StatedError>& stated_error() const {
    return shown_.stated_error;
  }

  /// Arrays of this object; as PressedBody::look().
  [[nodiscard]] BodyLook look() const;
  /// Appends a row of dots that comes to the place along the finger. @param radius  m
  void finger_dots(float radius, std::vector<Dot>& dots) const;

 private:
  void advance(std::span<const Capsule> capsules);

  std::shared_ptr<const TouchableBody> body_;
  CapsulePress solver_;
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

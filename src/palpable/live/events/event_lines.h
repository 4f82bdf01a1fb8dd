/// @file
/// What is told of a run, as lines of JSON: one that says what the others mean, then one for each
/// answered frame. docs/touch_events.md has the format.
#pragma once

#include "palpable/common/geometry/rigid.h"
#include "palpable/live/session/scene.h"
#include "palpable/live/session/session.h"

#include <Eigen/Core>

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace palpable {

/// What does not change of a body while it is played.
struct EventBody {
  std::string name;
  Rigid3 world_from_body = Rigid3::Identity();  ///< the world is the first frame's camera
  int vertices = 0, triangles = 0;              ///< of its skin
  /// m, body frame: the corners of the box around the skin at rest
  Eigen::Vector3d low = Eigen::Vector3d::Zero(), high = Eigen::Vector3d::Zero();
};

/// A session's bodies, in its order.
[[nodiscard]] std::vector<EventBody> event_bodies(const Session& session);

/// The first line, its end included.
[[nodiscard]] std::string hello_line(const std::vector<EventBody>& bodies);

/// Writes the lines of frames into memory that is used again: after the first touches it takes
/// none.
class EventLines {
 public:
  explicit EventLines(const std::vector<EventBody>& bodies);

  /// One line, its end included, until the next call. Points and forces have the digits that they
  /// have in touches.jsonl; a number that is not finite becomes null.
  /// @param scene  of the same bodies
  [[nodiscard]] std::string_view line_of(const Scene& scene);

  /// The same of what was answered between two frames (player/contact_ticks.h).
  /// @param frame    after which
  /// @param tick     from 1 on
  /// @param time     s, by the source's clock
  /// @param touches  of all bodies
  [[nodiscard]] std::string_view tick_line(int frame, int tick, double time,
                                           std::span<const Touch> touches);

 private:
  void add(std::string_view text) { text_ += text; }
  void add_number(double value, int decimals);
  void add_vector(const Eigen::Vector3d& v);
  void add_rows(const Rigid3& transform);
  void add_camera(const TrackedPose& camera);
  void add_body(const Scene& scene, int number);
  void add_touches(std::span<const Touch> touches, int number);
  void add_touch(const Touch& touch, const Rigid3& world_from_body);

  std::vector<std::string> names_;  // in quotes
  std::vector<Rigid3> world_from_body_;
  std::string text_;
};

}  // namespace palpable

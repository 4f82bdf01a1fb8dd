/// @file
/// Events of a run as lines of JSON: a first line that describes the others, then one line for each
/// processed frame. docs/touch_events.md has the format.
#pragma once

#include "palpable/common/geometry/rigid.h"
#include "palpable/live/session/scene.h"
#include "palpable/live/session/session.h"

#include <Eigen/Core>

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace palpable {

/// The properties of a body that stay constant during a session.
struct EventBody {
  std::string name;
  Rigid3 world_from_body = Rigid3::Identity();  ///< EventWorld says which world
  int vertices = 0, triangles = 0;              ///< of the skin
  /// m, body frame: the corners of the box around the skin at rest
  Eigen::Vector3d low = Eigen::Vector3d::Zero(), high = Eigen::Vector3d::Zero();
};

/// The bodies of a session, in the session's order.
[[nodiscard]] std::vector<EventBody> event_bodies(const Session& session);

/// Where the poses of bodies hold.
enum class EventWorld {
  kFirstCamera,  ///< the camera of the first frame
  kOfThings      ///< the frame in which what presses is given (session/things_line.h)
};

/// The first line, with its line break.
[[nodiscard]] std::string hello_line(const std::vector<EventBody>& bodies,
                                     EventWorld world = EventWorld::kFirstCamera);

/// What the line of a frame has in addition, in a run whose clients send what presses.
struct EventExtras {
  /// Lines of the client that were not solved, because this newer one had come.
  std::optional<int> skipped = {};
  bool vertices = false;  ///< the deformed skins
};

/// Formats the line of a frame. The text's memory is reused: after the first touches a line
/// allocates nothing.
class EventLines {
 public:
  explicit EventLines(const std::vector<EventBody>& bodies);

  /// Returns one line with its line break, valid until the next call. Points and forces have as
  /// many digits as in touches.jsonl; a number that is not finite becomes null.
  /// @param scene  with the bodies given to the constructor, in their order
  [[nodiscard]] std::string_view line_of(const Scene& scene, const EventExtras& extras = {});

  /// The same for the touches computed between two frames (player/contact_ticks.h).
  /// @param frame    number of the frame before
  /// @param tick     counted from 1 after each frame
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
  void add_body(const Scene& scene, int number, bool vertices);
  void add_touches(std::span<const Touch> touches, std::span<const std::int64_t> things,
                   int number);
  void add_touch(const Touch& touch, std::span<const std::int64_t> things,
                 const Rigid3& world_from_body);

  std::vector<std::string> names_;  // JSON strings, with quotes
  std::vector<Rigid3> world_from_body_;
  std::string text_;
};

}  // namespace palpable

/// @file
/// The answering half of a live run: what was seen of a frame in, touches and deformed bodies out
/// (paper Sec. 4).
///
///     colour + depth -> camera's pose -> what presses -> the object's surface -> touches
///                    -> u, sigma
///
/// Frames become colour + depth in the other half, DepthCamera (depth_camera.h). frame_loop.h runs
/// both halves on one thread, live/player on two.
///
/// Bodies stand still in the world, which is the camera frame of the first frame (or that of the
/// poses with which respond() is called).
///
/// Nothing here looks at a clock (except to say how long a stage took), draws random numbers or
/// keeps anything beyond its own state: the same frames give the same bytes. Contact and
/// reconstruction allocate nothing after the first frames.
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/geometry/frame.h"
#include "palpable/common/geometry/image.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/common/reduced/reduced_body.h"
#include "palpable/common/response/touchable_body.h"
#include "palpable/live/depth/depth_camera.h"
#include "palpable/live/map/anchored_scene.h"
#include "palpable/live/seen_object/object_surface.h"
#include "palpable/live/seen_object/pressing_mask.h"
#include "palpable/live/session/refiner.h"
#include "palpable/live/session/scene.h"
#include "palpable/live/session/session_body.h"
#include "palpable/live/slam/slam.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace palpable {

struct SessionSettings {
  ContactKind contact = ContactKind::kAnywhere;
  /// What was there when the bodies were anchored presses them, too: its desk, a wall. Else only
  /// what has come since presses (pressing_mask.h), and knowing that takes `map`.
  bool press_static = false;
  /// Follow the camera (tracker.h); false: it stands where it stood in the first frame.
  bool track = false;
  /// Find what moves (moving_mask.h), leave it out of the tracking, and fuse the rest into a map
  /// (surface_map.h) ten times a second; in which order: slam.h.
  bool map = true;
  /// With which the depth camera is made whose frames are answered.
  DepthSettings depth{};
  /// Its noise is replaced by what the camera says of its depths, and with our own matcher its
  /// fattening by what the windows add; session.cpp has the figures.
  ObjectSurfaceSettings surface{};
  PressingMaskSettings pressing{};
  TouchSettings touch{.entry = 1e-4};  ///< m: a tenth of what a camera knows
  PressSettings press{};
  PaperSettings paper{};
};

class Session {
 public:
  /// A problem when a setting is out of range.
  /// @param bodies  at least one, whose names differ where there are several
  /// @param camera  that turns frames of `format` to depth; it is read during this call only
  [[nodiscard]] static Result<Session> make(std::vector<PlacedBody> bodies,
                                            const DepthCamera& camera, const FrameFormat& format,
                                            const SessionSettings& settings = {});
  Session(Session&&) noexcept;
  Session& operator=(Session&&) noexcept;
  ~Session();

  /// Answers scene.seen: fills all other members, whose memory is used again, and adds the stages
  /// of this half to scene.times. Call it in the order of the frames.
  void respond(Scene& scene);

  /// The same with a pose that is known from elsewhere, in a session that does not follow the
  /// camera; all of its frames come with one. Bodies stand in the world of these poses.
  /// @param world_from_camera  nothing: it is not known in this frame, so that nothing presses
  void respond(Scene& scene, const std::optional<Rigid3>& world_from_camera);

  /// What scenes from now on have beside the rest; to begin with none of it. A scene allocates room
  /// for it once.
  void keep(const SceneExtras& extras);
  [[nodiscard]] const SceneExtras& kept() const;

  /// From now on exact answers are taken up where the first body is touched anywhere.
  void refine_with(Refiner refiner);
  /// Null without refine_with(), and where tables do not answer the first body.
  [[nodiscard]] Refiner* refiner();
  [[nodiscard]] const Refiner* refiner() const;

  /// Ends the session: its bodies where they stand, for another one. Of this one only
  /// settings() may be asked after it.
  [[nodiscard]] std::vector<PlacedBody> take_bodies();

  [[nodiscard]] int body_count() const;
  /// By number from 0 on, in the order of make(); as it is after the frame answered last.
  [[nodiscard]] const SessionBody& body(int number = 0) const;

  /// What each pixel of the frame answered last shows, near bodies: kShowsPresser where something
  /// may press it (geometry/image.h).
  [[nodiscard]] const MaskImage& shows() const;
  /// The room and the camera in it, as they have been seen so far: map, free space, tracker.
  [[nodiscard]] const Slam& slam() const;
  /// What belonged to the room when bodies were anchored, in the first frame; null without
  /// SessionSettings::map.
  [[nodiscard]] const AnchoredScene* anchored_scene() const;
  [[nodiscard]] const SessionSettings& settings() const;

 private:
  struct Parts;
  explicit Session(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace palpable

/// @file
/// The second half of a live run: turns the colour and depth of a frame into touches and deformed
/// bodies (paper Sec. 4).
///
///     colour + depth -> camera's pose -> pressing mask -> the obstacles' surface -> touches
///                    -> u, sigma
///
/// The first half, DepthCamera (depth_camera.h), turns frames into colour + depth. frame_loop.h
/// runs both halves on one thread, live/player on two.
///
/// Bodies are fixed in the world, which is the camera frame of the first frame (or that of the
/// poses with which respond() is called).
///
/// Nothing here reads a clock (except to time the stages), draws random numbers or keeps anything
/// beyond its own state: the same frames give the same bytes. Contact and reconstruction allocate
/// nothing after the first frames.
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
  /// Whether things that were there when the bodies were anchored, such as the desk or a wall,
  /// press them, too. Otherwise only things that came later press (pressing_mask.h), which requires
  /// `map`.
  bool press_static = false;
  /// Whether the camera is tracked (tracker.h); false: it does not move.
  bool track = false;
  /// Whether moving things are found (moving_mask.h) and left out of the tracking, and the rest is
  /// fused into a map (surface_map.h) ten times a second; slam.h has the order.
  bool map = true;
  /// The settings of the depth camera whose frames are processed.
  DepthSettings depth{};
  /// Its noise is replaced by that of the depth camera, and with our own matcher its fattening by
  /// that of the matching windows; session.cpp has the figures.
  ObjectSurfaceSettings surface{};
  /// With our own matcher, the shift that is expected of outlines (OutlineSearchSettings::expected)
  /// is replaced by its fattening.
  PressingMaskSettings pressing{};
  TouchSettings touch{.entry = 1e-4};  ///< m: a tenth of a camera's depth error
  /// Whether bodies with vibration modes have inertia: what is let go rings. False: they are always
  /// in the static state under the forces of the frame. The motion that a camera measures trembles,
  /// and so does a body that it hits.
  bool dynamics = false;
  PressSettings press{};
  PaperSettings paper{};
};

class Session {
 public:
  /// A problem when a setting is out of range.
  /// @param bodies  at least one, whose names differ where there are several
  /// @param camera  turns frames of `format` to depth; read during this call only
  [[nodiscard]] static Result<Session> make(std::vector<PlacedBody> bodies,
                                            const DepthCamera& camera, const FrameFormat& format,
                                            const SessionSettings& settings = {});
  Session(Session&&) noexcept;
  Session& operator=(Session&&) noexcept;
  ~Session();

  /// Processes scene.seen: fills all other members, whose memory is used again, and adds the stages
  /// of this half to scene.times. Call it in the order of the frames.
  void respond(Scene& scene);

  /// The same with a pose that is known from elsewhere, in a session that does not track the
  /// camera; all of its frames must come with one. Bodies are fixed in the world of these poses.
  /// @param world_from_camera  nothing: the pose is not known in this frame, and nothing presses
  void respond(Scene& scene, const std::optional<Rigid3>& world_from_camera);

  /// The additional arrays that scenes have from now on; none at first. A scene allocates room for
  /// them once.
  void keep(const SceneExtras& extras);
  [[nodiscard]] const SceneExtras& kept() const;

  /// From now on full-order solutions refine the contact of the first body, if it has tables of
  /// touch.
  void refine_with(Refiner refiner);
  /// Null without refine_with(), and if the first body is not solved by tables.
  [[nodiscard]] Refiner* refiner();
  [[nodiscard]] const Refiner* refiner() const;

  /// Ends the session and returns its bodies with their poses, for another session. Afterwards only
  /// settings() may be called.
  [[nodiscard]] std::vector<PlacedBody> take_bodies();

  [[nodiscard]] int body_count() const;
  /// A body by its number from 0 on, in the order of make(), in its state after the last frame.
  [[nodiscard]] const SessionBody& body(int number = 0) const;

  /// What each pixel of the last frame shows, near bodies: kShowsPresser where something may press
  /// one (geometry/image.h).
  [[nodiscard]] const MaskImage& shows() const;
  /// The share of each pixel of the last frame that shows a presser, near bodies
  /// (PressingMask::coverage()); null where it is not known.
  [[nodiscard]] const Image<float>* coverage() const;
  /// The room and the camera in it as seen so far: map, free space, tracker.
  [[nodiscard]] const Slam& slam() const;
  /// The room as it was when the bodies were anchored, in the first frame; null without
  /// SessionSettings::map.
  [[nodiscard]] const AnchoredScene* anchored_scene() const;
  [[nodiscard]] const SessionSettings& settings() const;

 private:
  struct Parts;
  explicit Session(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace palpable

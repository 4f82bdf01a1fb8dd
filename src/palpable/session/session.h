/// @file
/// A live run: a camera's frame in, a scene out (paper Sec. 4).
///
///     frame -> depth -> camera's pose -> what was not there before -> seen surface -> touches
///           -> u, sigma -> scene
///
/// The body stands still in the world, which is the camera frame of the first frame.
///
/// Nothing here looks at a clock (except to say how long a stage took), draws random numbers or
/// keeps anything beyond its own state: the same frames give the same bytes. Contact and
/// reconstruction allocate nothing after the first frames.
///
///   V  surface vertices of the body
#pragma once

#include "palpable/base/error.h"
#include "palpable/base/stage_clock.h"
#include "palpable/contact/paper_contact.h"
#include "palpable/contact/press_law.h"
#include "palpable/contact/seen_surface.h"
#include "palpable/contact/touch.h"
#include "palpable/depth/depth_camera.h"
#include "palpable/geometry/frame.h"
#include "palpable/geometry/rigid.h"
#include "palpable/map/anchored_scene.h"
#include "palpable/map/free_space.h"
#include "palpable/map/surface_map.h"
#include "palpable/reduced/reduced_body.h"
#include "palpable/track/tracker.h"

#include <Eigen/Core>

#include <memory>
#include <vector>

namespace palpable {

enum class ContactKind {
  kPress,  ///< level from the measured depth (press_law.h)
  kPaper   ///< Algorithm 1 as printed (paper_contact.h)
};

struct SessionSettings {
  ContactKind contact = ContactKind::kPress;
  /// Nothing that the first static_frames frames show presses; nothing at all presses while they
  /// are learnt. The camera has to stand still while they are.
  bool ignore_static = false;
  /// Follow the camera (tracker.h); false: it is taken to stand where it stood in the first frame.
  bool track = false;
  /// Find what moves (moving_mask.h), leave it out of the tracking, and fuse the rest into a map
  /// (surface_map.h) ten times a second; in which order: slam.h.
  bool map = false;
  int static_frames = 15;
  DepthSettings depth{};
  /// Two of them are fitted to the depth at which the body stands: the thickness is raised to 3
  /// sigma of it, the step lowered until points lie at most a quarter of the thickness apart. For
  /// stereo the left margin is at least 4 px, with OpenCV's matcher 12.
  SeenSurfaceSettings surface{};
  /// Its noise is replaced by what the camera says of its depths, times the share below.
  PressSettings press{};
  /// A touch is seen by many pixels, whose mean scatters less than each of them.
  double noise_share = 0.5;
  PaperSettings paper{};
};

/// All that is to be drawn, written or compared of one frame. Plain data.
struct Scene {
  int number = 0;
  double time = 0;                  ///< s, the frame's
  std::vector<Touch> touches;       ///< at most one at present
  Eigen::Matrix3Xf vertices;        ///< (3 x V) m, body frame, deformed
  Eigen::Matrix3Xf normals;         ///< (3 x V) unit, outwards
  std::vector<float> von_mises;     ///< (V) Pa; 0 at rest
  const SeenFrame* seen = nullptr;  ///< what it answers to; belongs to the caller or the session
  Rigid3 camera_from_body = Rigid3::Identity();  ///< where the body is drawn and touched
  TrackedPose camera;                            ///< identity and kFixed when nothing is tracked
  /// 255 where something moves, of the depth's size; null when it is not looked for, or when the
  /// camera is lost. Valid until the next frame.
  const MaskImage* moving = nullptr;
  StageTimes times;  ///< stages as in StageTimes: "track" ... "contact", "evaluate"
};

class Session {
 public:
  /// A problem when the format's numbers make no depth camera, or a setting is out of range.
  /// @param camera_from_body  where the body stands in the first frame's camera
  [[nodiscard]] static Result<Session> make(ReducedBody body, const Rigid3& camera_from_body,
                                            const FrameFormat& format,
                                            const SessionSettings& settings = {});
  Session(Session&&) noexcept;
  Session& operator=(Session&&) noexcept;
  ~Session();

  /// One frame, both halves below. The scene is valid until the next call.
  const Scene& process(const Frame& frame);

  /// First half: the camera's images to depth. Touches nothing that respond() touches, so the next
  /// frame may be seen on one thread while this one is answered on another.
  StageTimes see(const Frame& frame, SeenFrame& seen);

  /// Second half: depth to touches and the deformed body. Call it in the order of the frames.
  /// @param scene  overwritten; its memory is used again; scene.seen = &seen
  void respond(const SeenFrame& seen, Scene& scene);

  /// What may press, of the frame answered last: its depth without what is static and without the
  /// pixels at jumps; NaN elsewhere, and everywhere while the background is being learnt.
  [[nodiscard]] const DepthImage& pressing_depth() const;

  /// The scene as it has been seen so far; null without SessionSettings::map.
  [[nodiscard]] const SurfaceMap* map() const;
  /// Where it was seen free, and what belongs to the room in which the body was anchored: with the
  /// first frame. Both null without SessionSettings::map.
  [[nodiscard]] const FreeSpace* free_space() const;
  [[nodiscard]] const AnchoredScene* anchored_scene() const;

  [[nodiscard]] const ReducedBody& body() const;
  /// In the first frame's camera, which is the world: world_from_body.
  [[nodiscard]] const Rigid3& camera_from_body() const;
  /// What the tracker has done so far; all 0 when nothing is tracked.
  [[nodiscard]] TrackerCounts tracker_counts() const;
  /// Of all keyframes, as adjusted last; empty when nothing is tracked.
  [[nodiscard]] std::vector<KeyframePose> keyframes() const;
  [[nodiscard]] const SessionSettings& settings() const;
  /// Of SeenFrame::color and SeenFrame::depth.
  [[nodiscard]] const PinholeCamera& camera() const;
  [[nodiscard]] const PinholeCamera& depth_camera() const;

 private:
  struct Parts;
  explicit Session(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace palpable

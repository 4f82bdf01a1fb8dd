/// @file
/// The clip "press": where body and camera stand, and what the hand does.
///
/// Desk frame: metres; X to the right as the camera sees it, Y away from the camera, Z up; the desk
/// is Z = 0 and the body stands round the Z axis. Camera frame: the rectified left camera.
#pragma once

#include "palpable/base/error.h"
#include "palpable/geometry/rigid.h"
#include "palpable/geometry/surface_mesh.h"
#include "palpable/synth/hand.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace palpable {

/// What the desk knows of the virtual body: its skin and where it may be pressed. It is never
/// drawn.
struct DeskBody {
  SurfaceMesh surface;             ///< body frame
  std::vector<int> site_vertices;  ///< (S)
  Eigen::Matrix3Xd directions;     ///< (3 x S) unit, of the load: into the body
};

/// One press of the index finger: straight along the site's load direction.
struct PlannedPress {
  int site = 0;           ///< index in DeskBody::site_vertices
  double depth = 0;       ///< m the finger moves on from the first touch of the undeformed body
  int first_frame = 0;    ///< approach starts; no touch before
  int last_frame = 0;     ///< retreat ends; no touch after
  double view_angle = 0;  ///< rad between the touching surface's normal and the ray to the eye
  Eigen::Vector3d first_touch = Eigen::Vector3d::Zero();  ///< middle of the tip then, desk frame
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();    ///< desk frame
};

/// A span of frames.
struct FrameSpan {
  int first = 0;
  int last = 0;
};

/// The first frames of each clip have no hand.
inline constexpr int kFramesWithoutHand = 60;

/// The plan: a pure function of body, length and seed.
class PressClip {
 public:
  /// Chooses how the body is turned, three sites that the camera can see being pressed (the
  /// finger's touching surface faces the left eye within 70 degrees), and a path of the hand that
  /// meets the body in these presses only, passing in front of it and behind it between them.
  /// Every frame of the path is checked against all vertices.
  ///
  /// @param frames  >= 1; the hand's path fills those after kFramesWithoutHand, at any speed that
  ///                takes (300 is natural)
  /// @throws Error when no such sites or path are found
  static PressClip plan(const DeskBody& body, int frames, std::uint64_t seed);

  [[nodiscard]] int frame_count() const { return frames_; }
  /// The hand in the desk frame; nothing while it is away.
  [[nodiscard]] std::optional<HandPose> hand(int frame) const;

  /// The press that the frame belongs to, or null.
  [[nodiscard]] const PlannedPress* press_at(int frame) const;
  /// How far (m) the finger has moved on from the first touch, along the press; 0 outside one. The
  /// depth of a contact truth cannot exceed the finger's radius; this can.
  [[nodiscard]] double advance(int frame) const;

  [[nodiscard]] const Rigid3& camera_from_desk() const { return camera_from_desk_; }
  [[nodiscard]] const Rigid3& desk_from_body() const { return desk_from_body_; }
  [[nodiscard]] Rigid3 camera_from_body() const { return camera_from_desk_ * desk_from_body_; }

  [[nodiscard]] const std::vector<PlannedPress>& presses() const { return presses_; }
  [[nodiscard]] FrameSpan passes_in_front() const { return in_front_; }
  [[nodiscard]] FrameSpan passes_behind() const { return behind_; }

 private:
  /// The hand at one moment; between keys positions follow a monotone cubic, so no key is overshot.
  struct Key {
    double frame = 0;
    Eigen::Vector3d tip = Eigen::Vector3d::Zero();  ///< middle of the index finger tip, desk frame
    Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();  ///< desk from wrist
    double open = 0;  ///< 0 the pointing gesture, 1 the open one
  };
  struct Planner;

  [[nodiscard]] HandPose pose_at(double frame) const;
  [[nodiscard]] static HandPose pose_of(const Eigen::Vector3d& tip, const Eigen::Quaterniond& turn,
                                        const HandGesture& gesture);

  int frames_ = 0;
  std::uint64_t seed_ = 0;
  Rigid3 camera_from_desk_ = Rigid3::Identity();
  Rigid3 desk_from_body_ = Rigid3::Identity();
  std::vector<Key> keys_;
  std::vector<PlannedPress> presses_;
  FrameSpan in_front_, behind_;
};

}  // namespace palpable

#include "palpable/live/player/anchoring.h"

#include "palpable/common/base/error.h"
#include "palpable/common/base/stage_clock.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/desk/clip_files/scene_files.h"
#include "palpable/live/depth/depth_survey.h"
#include "palpable/live/map/plane_fit.h"
#include "palpable/live/slam/slam.h"
#include "palpable/live/sources/source_guard.h"

#include <fmt/core.h>

#include <cmath>
#include <functional>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

namespace palpable {
namespace {

// One second at a camera's usual rate.
constexpr int kFrames = 30;

// Largest number of unusable frames before the search ends. A failure that waits for a picture
// takes 0.1 s, so that a silent camera has 10 s for its first picture.
constexpr int kMostFailures = 100;

// m, distance from the body's origin at which poses are compared: half of a hand-sized body.
constexpr double kBodyReach = 0.1;

// A plane around a point belongs to the desk if it differs from the desk's plane by less than these
// bounds, which allow for noise.
constexpr double kSameHeight = 0.01;  // m
constexpr double kSameTilt = 0.15;    // rad

// Calls look() for each of the first usable frames.
// @return their number, at least one
int see_first_frames(FrameSource& source, const std::string& name, DepthCamera& camera,
                     const std::function<void(const SeenFrame&)>& look) {
  SourceGuard guard(source);
  Frame frame;
  SeenFrame seen;
  int looked = 0;
  for (int failures = 0; looked < kFrames && failures < kMostFailures;) {
    const FrameStatus status = guard.next(frame);
    if (status == FrameStatus::kEnd) break;
    if (status != FrameStatus::kFrame) {
      ++failures;
      continue;
    }
    ++looked;
    camera.see(frame, seen);
    if (seen.misfit) throw Error(fmt::format("{}: {}", name, seen.misfit->message()));
    look(seen);
  }
  if (looked == 0) {
    throw Error(fmt::format("{}: gives no picture that can be used{}{}", name,
                            guard.last_trouble().empty() ? "" : ": ", guard.last_trouble()));
  }
  return looked;
}

// What may be wrong with the depths, for the message of a search that has failed: the usual depth,
// and warnings.
std::string doubts_of(DepthSurvey& survey) {
  survey.finish();
  std::string text = "; " + text_of(survey.figures());
  while (text.ends_with('\n')) text.pop_back();
  for (const std::string& line : survey.take_warnings()) text += "; " + line;
  return text;
}

// What was found in one frame.
template <class Found>
struct Sighting {
  Rigid3 start_from_camera;  // start: the camera of the frame with which a session begins
  Found found;               // in this frame's camera
};

// Searches the first frames; returns at least one sighting, in the order of the frames.
// @param find_in  (frame, camera) -> optional Found, in the frame's camera
// @param missing  name of the thing that was not found, for the message
template <class FindIn>
auto find_in_first_frames(FrameSource& source, const std::string& name,
                          const DepthSettings& settings, const FindIn& find_in,
                          const std::string& missing) {
  using Found =
      typename std::invoke_result_t<FindIn, const SeenFrame&, const DepthCamera&>::value_type;
  Result<DepthCamera> made = DepthCamera::make(source.format(), settings);
  if (!made.ok()) throw Error(fmt::format("{}: {}", name, made.problem().message));
  DepthCamera camera = std::move(made).value();
  Slam slam(camera, {.map = false});
  const bool live = source.is_live();
  DepthSurvey survey("", source.format(), camera.rectified());
  std::vector<Sighting<Found>> sightings;  // with world_from_camera until the end
  Rigid3 world_from_start = Rigid3::Identity();
  StageTimes unused;
  const int looked = see_first_frames(source, name, camera, [&](const SeenFrame& seen) {
    survey.add(seen);
    const TrackedPose pose = slam.advance(seen, unused).camera;
    if (pose.new_world) sightings.clear();
    if (pose.state == TrackState::kLost) return;
    if (live) world_from_start = pose.world_from_camera;
    if (const std::optional<Found> found = find_in(seen, camera)) {
      sightings.push_back({pose.world_from_camera, *found});
    }
  });
  if (sightings.empty()) {
    throw NoPlaceError(fmt::format("{}: its first {} frames show no {}{}", name, looked, missing,
                                   doubts_of(survey)));
  }
  for (auto& sighting : sightings) {
    sighting.start_from_camera = world_from_start.inverse() * sighting.start_from_camera;
  }
  return sightings;
}

}  // namespace

namespace {

// A plane found in one frame on which a body may stand. plane.middle is the body's position.
struct StandingPlane {
  Plane plane;
  bool is_desk = true;  // the plane that all frames show; false: the surface of a thing
  bool is_free = true;  // nothing stands at plane.middle
};

std::optional<StandingPlane> plane_with_room(const SeenFrame& seen, const DepthNoise& noise,
                                             const Footprint& body) {
  std::optional<Plane> plane = fit_standing_plane(seen.depth, seen.depth_camera, noise);
  if (!plane) return std::nullopt;
  StandingPlane found{*plane};
  if (body.radius == 0) return found;
  const auto place = free_place_on(*plane, seen.depth, seen.depth_camera, noise, body);
  found.is_free = place.has_value();
  if (place) found.plane.middle = *place;
  return found;
}

// The plane at a pixel; the desk's plane if the surface at the pixel belongs to the desk.
std::optional<StandingPlane> plane_at_pixel(const SeenFrame& seen, const DepthNoise& noise,
                                            const Eigen::Vector2d& at_px) {
  const Eigen::Vector3d ray = seen.camera.unproject(at_px.x(), at_px.y(), 1.0);
  const Eigen::Vector2d at = seen.depth_camera.project(ray);
  const auto plane = fit_plane_at(seen.depth, seen.depth_camera, noise, at.x(), at.y());
  if (!plane) return std::nullopt;
  StandingPlane found{*plane, false};
  if (const auto desk = fit_standing_plane(seen.depth, seen.depth_camera, noise)) {
    const double above = desk->normal.dot(plane->middle) - desk->offset;
    if (std::abs(above) < kSameHeight && desk->normal.dot(plane->normal) > std::cos(kSameTilt)) {
      found = {*desk};
      found.plane.middle = ray * (desk->offset / desk->normal.dot(ray));
    }
  }
  return found;
}

}  // namespace

Rigid3 pose_on_plane(FrameSource& source, const std::string& name, const DepthSettings& settings,
                     const Spot& spot) {
  if (spot.at_px) {
    const FrameFormat& format = source.format();
    const Eigen::Vector2d at = *spot.at_px;
    if (!(at.x() >= 0 && at.y() >= 0 && at.x() < format.width && at.y() < format.height)) {
      throw Error(fmt::format("{}: the pixel {}, {} is outside of the picture of {} x {}", name,
                              at.x(), at.y(), format.width, format.height));
    }
  }
  // A camera's session begins with the last frame, a recording's with the first frame that
  // shows the plane.
  const bool live = source.is_live();
  std::optional<StandingPlane> chosen;
  const auto plane_in = [&](const SeenFrame& seen,
                            const DepthCamera& camera) -> std::optional<StandingPlane> {
    if (chosen && !live) {  // further frames only improve the desk's plane
      if (!chosen->is_desk) return std::nullopt;
      return plane_with_room(seen, camera.noise(), {});
    }
    const auto found = spot.at_px ? plane_at_pixel(seen, camera.noise(), *spot.at_px)
                                  : plane_with_room(seen, camera.noise(), spot.body);
    if (found) chosen = found;
    return found;
  };
  const auto sightings = find_in_first_frames(
      source, name, settings, plane_in,
      spot.at_px ? fmt::format("surface at pixel {}, {}", spot.at_px->x(), spot.at_px->y())
                 : "plane to stand on (within 1.5 m, a tenth of what is seen there, facing up in "
                   "the picture, or half of it, facing the camera); turn the camera to the desk");
  // The position on the plane comes from the sighting nearest in time to the start frame.
  const auto& nearest = live ? sightings.back() : sightings.front();
  if (!nearest.found.is_free) {
    throw NoPlaceError(fmt::format(
        "{}: on the desk that is seen no place of {:.2f} m is free for the body; clear one", name,
        2 * spot.body.radius));
  }
  const Eigen::Vector3d middle = nearest.start_from_camera * nearest.found.plane.middle;
  std::vector<Rigid3> poses;
  for (const auto& [start_from_camera, found] : sightings) {
    if (found.is_desk != nearest.found.is_desk) continue;
    Plane plane = moved_by(start_from_camera, found.plane);
    // Every frame has another plane.middle. All poses must be of the same point, projected to each
    // frame's own plane.
    plane.middle = middle - (plane.normal.dot(middle) - plane.offset) * plane.normal;
    poses.push_back(camera_from_body_on(plane));
  }
  return median_pose(poses, kBodyReach);
}

std::optional<Rigid3> pose_on_desk(const SeenFrame& seen, const DepthNoise& noise,
                                   const Footprint& body) {
  const std::optional<StandingPlane> found = plane_with_room(seen, noise, body);
  if (!found || !found->is_free) return std::nullopt;
  return camera_from_body_on(found->plane);
}

Rigid3 pose_on_board(FrameSource& source, const std::string& name, const DepthSettings& settings,
                     const BoardPattern& pattern) {
  const auto board_in = [&](const SeenFrame& seen, const DepthCamera&) {
    return find_board_pose(seen.color, seen.camera, pattern);
  };
  const auto sightings = find_in_first_frames(
      source, name, settings, board_in,
      fmt::format("chessboard of {}x{} inner corners; show it whole, flat and sharp",
                  pattern.columns, pattern.rows));
  std::vector<Rigid3> poses;
  for (const auto& [start_from_camera, found] : sightings) {
    poses.push_back(start_from_camera * found);
  }
  return median_pose(poses, kBodyReach);
}

std::optional<Rigid3> pose_at_pixel(const SeenFrame& seen, const DepthNoise& noise,
                                    const Eigen::Vector2d& at_px) {
  const std::optional<StandingPlane> found = plane_at_pixel(seen, noise, at_px);
  if (!found) return std::nullopt;
  return camera_from_body_on(found->plane);
}

}  // namespace palpable

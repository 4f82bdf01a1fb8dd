#include "palpable/live/track/new_landmarks.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpable {
namespace {

constexpr int kPatchBorder = 9;  // px from the border, so that a corner's patch fits the picture
// px; smallest disparity of a new landmark, below which its depth is too uncertain. It is larger
// than LandmarkSearch::kLeastDisparity, because a known landmark already has a depth.
constexpr double kLeastNewDisparity = 0.5;
// px; largest difference between the disparity from the depth image and the patch's own. Where it
// is larger, the corner lies on an edge between a near and a far surface.
constexpr double kMostDisagreement = 1.5;

// A corner that is this close to the predicted position of an old landmark and at the same depth is
// taken for that landmark. Without this test the map would fill with copies of landmarks that were
// not seen in a few keyframes.
constexpr double kSamePlacePx = 2;
constexpr double kSameDepthSigmas = 3;  // sigmas of d

// Sigma of a landmark's first sighting, as a share of the usual sigma. It has no error of matching,
// because the patch is cut there, only the noise of the picture.
constexpr double kFirstSighting = 0.7;

}  // namespace

void NewLandmarks::add(const LandmarkSearch& search, const TrackerFrame& frame,
                       const PoseSearch& seen, int frame_count, LandmarkMap& map) {
  const TrackerSettings& settings = search.settings;
  const TrackCamera& camera = settings.camera;
  std::vector<Eigen::Vector2d> taken;
  seen.for_each_inlier([&](const Candidate&, const PosePoint& point) {
    taken.emplace_back(point.seen.uvd.head<2>());
  });
  const int most = settings.most_landmarks + kNewLandmarks - static_cast<int>(taken.size());
  const std::vector<Corner> corners =
      new_corners(search.pyramid.level(1), *frame.depth, frame.moving, taken,
                  LandmarkSearch::kCellsAcross, most);
  find_unseen(search, frame, seen, map.keyframes.back());
  for (const Corner& corner : corners) {
    if (map.room_for_landmarks(settings.limits.landmarks) <= 0) break;
    const Eigen::Vector2d& uv = corner.uv;
    if (!(uv.x() > kPatchBorder && uv.y() > kPatchBorder &&
          uv.x() < camera.camera.width - kPatchBorder - 1 &&
          uv.y() < camera.camera.height - kPatchBorder - 1)) {
      continue;
    }
    const double expected = camera.camera.fx_px * camera.baseline / corner.depth;
    const std::optional<double> d = search.disparity_at(frame, uv, expected);
    if (!d || *d - camera.disparity_error_px < kLeastNewDisparity ||
        std::abs(*d - expected) > kMostDisagreement)
      continue;
    if (is_old_landmark(search, frame, {uv.x(), uv.y(), *d}, frame_count, map)) continue;
    Landmark landmark = landmark_at(search, frame, corner, *d, map);
    landmark.last_frame = frame_count;
    map.add(std::move(landmark), map.keyframes.back());
  }
}

// Finds the landmarks that should be visible in this keyframe but were not found or not searched.
void NewLandmarks::find_unseen(const LandmarkSearch& search, const TrackerFrame& frame,
                               const PoseSearch& seen, const Keyframe& keyframe) {
  unseen_.clear();
  if (seen.is_blurred()) return;  // landmarks may be missing because of the smear
  std::vector<char> done(search.map.landmarks.size(), 0);
  seen.for_each_inlier(
      [&](const Candidate& candidate, const PosePoint&) { done[candidate.landmark] = 1; });
  for (std::size_t i = 0; i < search.map.landmarks.size(); ++i) {
    if (done[i] != 0) continue;
    const auto candidate = search.expected(frame, static_cast<int>(i), keyframe.camera_from_world);
    if (candidate) unseen_.push_back(*candidate);
  }
}

// Whether a corner is an old landmark. The landmark is searched there once more. If it is found,
// the sighting is added to the keyframe; if not, its look has changed and it is marked as dead.
bool NewLandmarks::is_old_landmark(const LandmarkSearch& search, const TrackerFrame& frame,
                                   const Eigen::Vector3d& uvd, int frame_count, LandmarkMap& map) {
  const TrackCamera& camera = search.settings.camera;
  Keyframe& keyframe = map.keyframes.back();
  for (Candidate& candidate : unseen_) {
    if ((candidate.uv - uvd.head<2>()).squaredNorm() > kSamePlacePx * kSamePlacePx) continue;
    Landmark& landmark = map.landmarks[candidate.landmark];
    if (!landmark.alive) continue;
    candidate.warp = image_from_anchor(camera, landmark, anchor_pose(landmark, map.keyframes),
                                       keyframe.camera_from_world);
    Eigen::Vector2d uv;
    int level = 0;
    const bool found = search.find(candidate, 1, 0, LandmarkSearch::kFineLikeness, uv, level);
    const Sighting seen = search.sighting_of(frame, candidate, found ? uv : candidate.uv, level);
    const double off = std::abs(camera.disparity_at(candidate.depth) - uvd.z());
    if (off > kSameDepthSigmas * std::max(seen.sigma_d, LandmarkSearch::kSigmaStereo)) {
      continue;  // another surface
    }
    if (!found || (uv - candidate.uv).norm() > kSamePlacePx) {
      landmark.alive = false;
      continue;
    }
    landmark.sightings.push_back({static_cast<int>(map.keyframes.size()) - 1, seen});
    landmark.last_frame = frame_count;
    keyframe.landmarks.push_back(candidate.landmark);
    return true;
  }
  return false;
}

Landmark NewLandmarks::landmark_at(const LandmarkSearch& search, const TrackerFrame& frame,
                                   const Corner& corner, double disparity, const LandmarkMap& map) {
  const int index = static_cast<int>(map.keyframes.size()) - 1;
  const Rigid3 world_from_camera = map.keyframes.back().camera_from_world.inverse(Eigen::Isometry);
  Landmark landmark;
  landmark.uv = corner.uv;
  landmark.anchor = index;
  landmark.slope = corner.slope;
  Sighting seen;
  seen.uvd = {corner.uv.x(), corner.uv.y(), disparity};
  seen.sigma = kFirstSighting * search.sigma_of_pixel();
  seen.sigma_d = search.sigma_of_disparity(frame, disparity);
  landmark.x_in_world = world_from_camera * search.settings.camera.point(seen.uvd);
  landmark.look = PatchSource::cut(search.pyramid, corner.uv);
  landmark.sightings.push_back({index, seen});
  return landmark;
}

}  // namespace palpable

#include "palpable/live/track/landmark_search.h"

#include "palpable/live/track/picture_shift.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpable {
namespace {

constexpr int kBorder = 8;            // px from the border, so that a template fits the picture
constexpr double kLeastCosine = 0.6;  // of the angle between the rays then and now: 53 degrees
constexpr double kLargestZoom = 2.3;  // ratio of the distances then and now, or its inverse
// A surface is taken to hide a landmark if its depth is less than this share of the landmark's.
constexpr double kHides = 0.9;
// Correlation that is needed in the search along a row. It is higher than kFineLikeness, because
// repeated textures are easily mistaken along a row.
constexpr double kRowLikeness = 0.8;
// Lower limit of sigma_d, px, of a disparity that is computed from a measured depth.
constexpr double kLeastSigmaOfDepth = 0.05;

// The worth of a landmark by its record so far (Candidate::worth); a new one begins with 1/2.
double worth_of(const Landmark& landmark, int frame_count) {
  const int total = landmark.inlier + 2 * landmark.outlier + landmark.missed;
  return (landmark.inlier + 1.0) / (total + 2.0) +
         (landmark.last_frame >= frame_count - 2 ? 0.5 : 0.0) +
         0.02 * static_cast<double>(std::min<std::size_t>(landmark.sightings.size(), 20));
}

}  // namespace

std::optional<Candidate> LandmarkSearch::expected(const TrackerFrame& frame, int id,
                                                  const Rigid3& camera_from_world) const {
  const PinholeCamera& camera = settings.camera.camera;
  const Landmark& landmark = map.landmarks[id];
  if (!landmark.alive) return std::nullopt;
  const Eigen::Vector3d x = camera_from_world * landmark.x_in_world;
  if (x.z() < kNearestSeen) return std::nullopt;
  const Eigen::Vector2d uv = camera.project(x);
  if (!(uv.x() > kBorder && uv.y() > kBorder && uv.x() < camera.width - kBorder - 1 &&
        uv.y() < camera.height - kBorder - 1)) {
    return std::nullopt;
  }

  const Eigen::Vector3d eye =
      camera_from_world.linear().transpose() * -camera_from_world.translation();
  const Rigid3& anchor_from_world = anchor_pose(landmark, map.keyframes);
  const Eigen::Vector3d then = landmark.x_in_world - anchor_from_world.inverse().translation();
  const Eigen::Vector3d now = landmark.x_in_world - eye;
  const double zoom = then.norm() / now.norm();
  if (then.dot(now) < kLeastCosine * then.norm() * now.norm() || zoom > kLargestZoom ||
      zoom < 1 / kLargestZoom) {
    return std::nullopt;
  }
  const double depth_scale = static_cast<double>(frame.depth->width()) / camera.width;
  const int dx = static_cast<int>((uv.x() + 0.5) * depth_scale);
  const int dy = static_cast<int>((uv.y() + 0.5) * depth_scale);
  if (frame.moving != nullptr && !frame.moving->empty() && (*frame.moving)(dx, dy) != 0) {
    return std::nullopt;
  }
  // An unknown depth (NaN) hides nothing.
  const double hidden = settings.camera.measured_depth(kHides * x.z());
  if (static_cast<double>((*frame.depth)(dx, dy)) < hidden) return std::nullopt;
  Candidate candidate;
  candidate.landmark = id;
  candidate.uv = uv;
  candidate.depth = x.z();
  return candidate;
}

void LandmarkSearch::select(const TrackerFrame& frame, const Rigid3& camera_from_world,
                            const Rigid3& previous_from_world, double exposure, int frame_count,
                            std::vector<int>& cells, std::vector<Candidate>& candidates) const {
  const PinholeCamera& camera = settings.camera.camera;
  candidates.clear();
  const double cell = static_cast<double>(camera.width) / kCellsAcross;
  const int down = static_cast<int>(std::ceil(camera.height / cell));
  cells.assign(kCellsAcross * down, -1);
  for (std::size_t i = 0; i < map.landmarks.size(); ++i) {
    std::optional<Candidate> candidate = expected(frame, static_cast<int>(i), camera_from_world);
    if (!candidate) continue;
    candidate->worth = worth_of(map.landmarks[i], frame_count);
    const int cx = std::min(static_cast<int>(candidate->uv.x() / cell), kCellsAcross - 1);
    const int cy = std::min(static_cast<int>(candidate->uv.y() / cell), down - 1);
    int& slot = cells[cy * kCellsAcross + cx];
    if (slot < 0) {
      slot = candidate->turn = static_cast<int>(candidates.size());
      candidates.push_back(*candidate);
    } else if (candidates[slot].worth < candidate->worth) {
      candidate->turn = slot;
      candidates[slot] = *candidate;
    }
  }
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return a.worth != b.worth ? a.worth > b.worth : a.turn < b.turn;
  });
  if (std::ssize(candidates) > settings.most_landmarks) candidates.resize(settings.most_landmarks);
  for (Candidate& candidate : candidates) {
    const Landmark& landmark = map.landmarks[candidate.landmark];
    candidate.warp = image_from_anchor(settings.camera, landmark,
                                       anchor_pose(landmark, map.keyframes), camera_from_world);
    const Eigen::Vector3d x = previous_from_world * landmark.x_in_world;
    if (x.z() > kNearestSeen) candidate.smear = exposure * (candidate.uv - camera.project(x));
  }
}

bool LandmarkSearch::find(const Candidate& candidate, int coarsest, int finest,
                          double least_likeness, Eigen::Vector2d& uv, int& level) const {
  const Landmark& landmark = map.landmarks[candidate.landmark];
  bool found = false;
  uv = candidate.uv;
  PatchTemplate look;
  for (int l = coarsest; l >= finest; --l) {
    if (!look.warp(landmark.look, l, candidate.warp, candidate.smear / (1 << l))) continue;
    const PatchMatch match =
        follow(pyramid.level(l), look, Pyramid::to_level(uv, l), {.steps = 10, .farthest = 6});
    if (!match.found || match.likeness < least_likeness) {
      // The result of the coarser level is returned, which has that level's larger sigma.
      return found;
    }
    uv = Pyramid::from_level(match.at, l);
    level = l;
    found = true;
  }
  return found;
}

std::optional<double> LandmarkSearch::disparity_at(const TrackerFrame& frame,
                                                   const Eigen::Vector2d& uv,
                                                   double expected) const {
  const TrackCamera& camera = settings.camera;
  if (frame.right == nullptr) {
    const double scale = static_cast<double>(frame.depth->width()) / camera.camera.width;
    const auto x = static_cast<int>((uv.x() + 0.5) * scale);
    const auto y = static_cast<int>((uv.y() + 0.5) * scale);
    const auto Z = static_cast<double>((*frame.depth)(x, y));
    if (!(Z > 0)) return std::nullopt;
    return camera.camera.fx_px * camera.baseline / Z;
  }
  PatchTemplate look;
  if (!look.cut(*frame.left, uv.x(), uv.y())) return std::nullopt;
  const double infinity = settings.disparity_at_infinity_px;
  const Eigen::Vector2d start(uv.x() - expected - infinity, uv.y());
  const PatchMatch match =
      follow(*frame.right, look, start, {.steps = 8, .along_row = true, .farthest = 3});
  if (!match.found || match.likeness < kRowLikeness) return std::nullopt;
  return uv.x() - match.at.x() - infinity;
}

Sighting LandmarkSearch::sighting_of(const TrackerFrame& frame, const Candidate& candidate,
                                     const Eigen::Vector2d& uv, int level) const {
  const TrackCamera& camera = settings.camera;
  Sighting seen;
  const double expected = camera.disparity_at(candidate.depth);
  const double scale = (1 << level) * (1 + candidate.smear.norm() / (4 << level));
  seen.sigma = sigma_of_pixel() * scale;
  seen.uvd = {uv.x(), uv.y(), std::numeric_limits<double>::quiet_NaN()};
  if (const std::optional<double> d = disparity_at(frame, uv, expected);
      d && *d - camera.disparity_error_px > kLeastDisparity) {
    seen.uvd.z() = *d;
    seen.sigma_d = sigma_of_disparity(frame, *d);
    if (frame.right != nullptr) seen.sigma_d *= std::max(1.0, 0.5 * scale);
  }
  return seen;
}

double LandmarkSearch::sigma_of_disparity(const TrackerFrame& frame, double d) const {
  if (frame.right != nullptr) return kSigmaStereo;
  const double f_T = settings.camera.camera.fx_px * settings.camera.baseline;
  const double Z = f_T / d;
  const double sigma = f_T * settings.noise.sigma(Z) / (Z * Z);
  return settings.two_sensors ? std::max(kLeastSigmaOfDepth, sigma) : std::max(0.2, 2 * sigma);
}

}  // namespace palpable

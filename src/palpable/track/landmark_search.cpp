#include "palpable/track/landmark_search.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace palpable {
namespace {

constexpr double kLeastCosine = 0.6;  // between the rays of then and now: 53 degrees
constexpr double kLargestZoom = 2.3;
// A surface that is measured nearer than this share of a landmark's depth hides it.
constexpr double kHides = 0.9;
constexpr double kRowLikeness = 0.8;

}  // namespace

std::optional<Candidate> LandmarkSearch::expected(const TrackerFrame& frame, int id,
                                                  const Rigid3& pose) const {
  const TrackCamera& camera = settings.camera;
  const Landmark& landmark = landmarks[static_cast<std::size_t>(id)];
  if (!landmark.alive) return std::nullopt;
  const int width = camera.camera.width;
  const int height = camera.camera.height;
  const Eigen::Vector3d x = pose * landmark.x_in_world;
  if (x.z() < kNearest) return std::nullopt;
  const Eigen::Vector2d uv = camera.camera.project(x);
  if (!(uv.x() > 8 && uv.y() > 8 && uv.x() < width - 9 && uv.y() < height - 9)) return std::nullopt;

  const Eigen::Vector3d eye = pose.linear().transpose() * -pose.translation();
  const Rigid3& anchor = anchor_pose(landmark, keyframes);
  const Eigen::Vector3d then = landmark.x_in_world - anchor.inverse().translation();
  const Eigen::Vector3d now = landmark.x_in_world - eye;
  const double zoom = then.norm() / now.norm();
  if (then.dot(now) < kLeastCosine * then.norm() * now.norm() || zoom > kLargestZoom ||
      zoom < 1 / kLargestZoom) {
    return std::nullopt;
  }
  const double depth_scale = static_cast<double>(frame.depth->width()) / width;
  const int dx = static_cast<int>((uv.x() + 0.5) * depth_scale);
  const int dy = static_cast<int>((uv.y() + 0.5) * depth_scale);
  if (frame.moving != nullptr && !frame.moving->empty() && (*frame.moving)(dx, dy) != 0) {
    return std::nullopt;
  }
  if (static_cast<double>((*frame.depth)(dx, dy)) < kHides * x.z()) return std::nullopt;  // NaN: no
  Candidate candidate;
  candidate.landmark = id;
  candidate.uv = uv;
  candidate.depth = x.z();
  return candidate;
}

void LandmarkSearch::select(const TrackerFrame& frame, const Rigid3& pose, const Rigid3& before,
                            double exposure, int number, std::vector<int>& cells,
                            std::vector<Candidate>& candidates) const {
  const TrackCamera& camera = settings.camera;
  candidates.clear();
  const double cell = static_cast<double>(camera.camera.width) / kCellsAcross;
  const int down = static_cast<int>(std::ceil(camera.camera.height / cell));
  cells.assign(static_cast<std::size_t>(kCellsAcross * down), -1);
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    std::optional<Candidate> candidate = expected(frame, static_cast<int>(i), pose);
    if (!candidate) continue;
    const Landmark& landmark = landmarks[i];
    const int total = landmark.inlier + 2 * landmark.outlier + landmark.missed;
    candidate->worth =
        (landmark.inlier + 1.0) / (total + 2.0) + (landmark.last_frame >= number - 2 ? 0.5 : 0.0) +
        0.02 * static_cast<double>(std::min<std::size_t>(landmark.sightings.size(), 20));
    const int cx = std::min(static_cast<int>(candidate->uv.x() / cell), kCellsAcross - 1);
    const int cy = std::min(static_cast<int>(candidate->uv.y() / cell), down - 1);
    int& slot = cells[static_cast<std::size_t>(cy * kCellsAcross + cx)];
    if (slot < 0) {
      slot = candidate->turn = static_cast<int>(candidates.size());
      candidates.push_back(*candidate);
    } else if (candidates[static_cast<std::size_t>(slot)].worth < candidate->worth) {
      candidate->turn = slot;
      candidates[static_cast<std::size_t>(slot)] = *candidate;
    }
  }
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return a.worth != b.worth ? a.worth > b.worth : a.turn < b.turn;
  });
  if (candidates.size() > static_cast<std::size_t>(settings.most_landmarks)) {
    candidates.resize(static_cast<std::size_t>(settings.most_landmarks));
  }
  for (Candidate& candidate : candidates) {
    const Landmark& landmark = landmarks[static_cast<std::size_t>(candidate.landmark)];
    candidate.warp = image_from_anchor(camera, landmark, anchor_pose(landmark, keyframes), pose);
    const Eigen::Vector3d x = before * landmark.x_in_world;
    if (x.z() > kNearest) candidate.smear = exposure * (candidate.uv - camera.camera.project(x));
  }
}

bool LandmarkSearch::find(const Candidate& candidate, int coarsest, int finest,
                          double least_likeness, Eigen::Vector2d& uv, int& level) const {
  const Landmark& landmark = landmarks[static_cast<std::size_t>(candidate.landmark)];
  bool found = false;
  uv = candidate.uv;
  PatchTemplate look;
  for (int l = coarsest; l >= finest; --l) {
    if (!look.warp(landmark.look, l, candidate.warp, candidate.smear / (1 << l))) continue;
    const PatchMatch match =
        follow(pyramid.level(l), look, Pyramid::to_level(uv, l), {.steps = 10, .farthest = 6});
    if (!match.found || match.likeness < least_likeness) {
      // What was found in a smaller image stands; it is less well known.
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
  if (!look.take(*frame.left, uv.x(), uv.y())) return std::nullopt;
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
  const double f_T = camera.camera.fx_px * camera.baseline;
  const double expected = f_T / candidate.depth;
  const double scale = (1 << level) * (1 + candidate.smear.norm() / (4 << level));
  seen.sigma = kSigma * scale;
  seen.uvd = {uv.x(), uv.y(), std::numeric_limits<double>::quiet_NaN()};
  if (const std::optional<double> d = disparity_at(frame, uv, expected); d && *d > 0.3) {
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
  return std::max(0.2, 2 * f_T * settings.noise.sigma(Z) / (Z * Z));
}

}  // namespace palpable

#include "palpable/live/track/window.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace palpable {
namespace {

constexpr std::size_t kHeld = 5;        // largest number of older keyframes that are held fixed
constexpr int kLeastShared = 5;         // landmarks that each of them must share with the window
constexpr int kStepsToNewLengths = 20;  // all points and keyframes are off by the same share
constexpr double kBadSquared = 16;      // (4 sigma)^2; sightings with a larger residual are dropped

// Indices of the landmarks seen in keyframes `first` and later, without duplicates, in rising
// order.
std::vector<int> landmarks_since(int first, const LandmarkMap& map) {
  std::vector<int> ids;
  for (std::size_t k = first; k < map.keyframes.size(); ++k) {
    const std::vector<int>& seen = map.keyframes[k].landmarks;
    ids.insert(ids.end(), seen.begin(), seen.end());
  }
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

// The keyframes before `first` that share the most of these landmarks, the most first.
std::vector<int> held_keyframes(int first, const std::vector<int>& ids, const LandmarkMap& map) {
  std::vector<int> shared(first, 0);
  for (const int id : ids) {
    for (const KeyframeSighting& s : map.landmarks[id].sightings) {
      if (s.keyframe < first) ++shared[s.keyframe];
    }
  }
  std::vector<int> held(first);
  std::iota(held.begin(), held.end(), 0);
  std::stable_sort(held.begin(), held.end(), [&](int a, int b) { return shared[a] > shared[b]; });
  if (held.size() > kHeld) held.resize(kHeld);
  std::erase_if(held, [&](int k) { return shared[k] < kLeastShared; });
  return held;
}

// Adds the landmarks that at least two of the window's keyframes have seen.
// @param slot  (keyframes of the map) index in the window, -1: not in it
void add_landmarks(const std::vector<int>& ids, const std::vector<int>& slot,
                   const LandmarkMap& map, AdjustmentWindow& window) {
  for (const int id : ids) {
    const Landmark& landmark = map.landmarks[id];
    if (!landmark.alive) continue;
    const auto count =
        std::count_if(landmark.sightings.begin(), landmark.sightings.end(),
                      [&](const KeyframeSighting& s) { return slot[s.keyframe] >= 0; });
    if (count < 2) continue;
    const int point = static_cast<int>(window.landmarks.size());
    window.landmarks.push_back(id);
    window.problem.x_in_world.push_back(landmark.x_in_world);
    for (const KeyframeSighting& s : landmark.sightings) {
      const int pose = slot[s.keyframe];
      if (pose >= 0) window.problem.sightings.push_back({pose, point, s.seen});
    }
  }
}

// Moves the landmarks that were not adjusted to where their measured disparities put them, if the
// adjustment assumed another disparity error than the one with which they were placed. Their
// anchors have not moved yet.
void place_by_disparity(const AdjustmentWindow& window, LandmarkMap& map) {
  const TrackCamera& now = window.problem.camera;
  for (const int k : window.keyframes) {
    const Rigid3& camera_from_world = map.keyframes[k].camera_from_world;
    for (const int id : map.keyframes[k].landmarks) {
      Landmark& landmark = map.landmarks[id];
      if (landmark.anchor != k) continue;
      const Eigen::Vector3d x = camera_from_world * landmark.x_in_world;
      const double d = window.map_camera.disparity_at(x.z());
      if (!(x.z() > 0 && d > now.disparity_error_px)) continue;
      landmark.x_in_world =
          camera_from_world.inverse(Eigen::Isometry) * (now.depth_at(d) / x.z() * x);
    }
  }
}

}  // namespace

AdjustmentWindow window_of(const TrackCamera& camera, const LandmarkMap& map) {
  AdjustmentWindow window;
  window.problem.camera = window.map_camera = camera;
  const int keyframes = static_cast<int>(map.keyframes.size());
  const int first = keyframes - std::min(kWindow, keyframes);
  const std::vector<int> ids = landmarks_since(first, map);
  const std::vector<int> held = held_keyframes(first, ids, map);
  std::vector<int> slot(keyframes, -1);
  const auto add_pose = [&](int k, bool fixed) {
    slot[k] = static_cast<int>(window.keyframes.size());
    window.keyframes.push_back(k);
    window.problem.camera_from_world.push_back(map.keyframes[k].camera_from_world);
    window.problem.fixed.push_back(fixed ? 1 : 0);
  };
  for (const int k : held) add_pose(k, true);
  for (int k = first; k < keyframes; ++k) add_pose(k, k == 0 || (held.empty() && k == first));
  add_landmarks(ids, slot, map, window);
  return window;
}

void adjust(AdjustmentWindow& window) {
  BundleProblem& problem = window.problem;
  const BundleResult result =
      adjust_bundle(problem, {.measure_disparity_error = window.watch.has_value()});
  if (window.watch) {
    const std::optional<double> error = window.watch->add(
        result.disparity_error_px, result.disparity_information, problem.camera.disparity_error_px);
    if (error) adjust_with_error(window, *error);
  }
  for (const BundleSighting& s : window.problem.sightings) {
    if (squared_residual(window.problem, s) > kBadSquared) {
      window.bad.emplace_back(window.landmarks[s.point], window.keyframes[s.pose]);
    }
  }
}

void adjust_with_error(AdjustmentWindow& window, double disparity_error_px) {
  BundleProblem& problem = window.problem;
  problem.camera.disparity_error_px = disparity_error_px;
  const auto oldest = std::min_element(window.keyframes.begin(), window.keyframes.end());
  std::fill(problem.fixed.begin(), problem.fixed.end(), 0);
  problem.fixed[oldest - window.keyframes.begin()] = 1;
  adjust_bundle(problem, {.steps = kStepsToNewLengths});
}

void put_back(const AdjustmentWindow& window, LandmarkMap& map) {
  if (window.problem.camera != window.map_camera) place_by_disparity(window, map);
  std::vector<std::optional<Rigid3>> world_from_old_world(map.keyframes.size());
  for (std::size_t i = 0; i < window.keyframes.size(); ++i) {
    if (window.problem.fixed[i] != 0) continue;
    const int k = window.keyframes[i];
    Rigid3& pose = map.keyframes[k].camera_from_world;
    world_from_old_world[k] = window.problem.camera_from_world[i].inverse(Eigen::Isometry) * pose;
    pose = window.problem.camera_from_world[i];
  }
  std::vector<char> placed(map.landmarks.size(), 0);
  for (std::size_t j = 0; j < window.landmarks.size(); ++j) {
    const int id = window.landmarks[j];
    map.landmarks[id].x_in_world = window.problem.x_in_world[j];
    placed[id] = 1;
  }
  move_landmarks(world_from_old_world, placed, map);
  for (const auto& [id, k] : window.bad) {
    Landmark& landmark = map.landmarks[id];
    std::erase_if(landmark.sightings,
                  [k = k](const KeyframeSighting& s) { return s.keyframe == k; });
    if (landmark.sightings.size() < 2 || k == landmark.anchor) landmark.alive = false;
  }
}

void move_landmarks(const std::vector<std::optional<Rigid3>>& world_from_old_world,
                    const std::vector<char>& placed, LandmarkMap& map) {
  for (std::size_t k = 0; k < map.keyframes.size(); ++k) {
    if (!world_from_old_world[k]) continue;
    for (const int id : map.keyframes[k].landmarks) {
      Landmark& landmark = map.landmarks[id];
      if (placed[id] == 0 && landmark.anchor == static_cast<int>(k)) {
        landmark.x_in_world = *world_from_old_world[k] * landmark.x_in_world;
      }
    }
  }
}

}  // namespace palpable

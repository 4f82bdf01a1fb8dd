#include "palpable/track/window.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace palpable {
namespace {

constexpr std::size_t kHeld = 5;    // older keyframes
constexpr int kLeastShared = 5;     // points that one of them has in common
constexpr double kBadSquared = 16;  // a sighting beyond 4 sigmas after an adjustment is dropped

}  // namespace

Window window_of(const TrackCamera& camera, const std::vector<Keyframe>& keyframes,
                 const std::vector<Landmark>& landmarks) {
  Window window;
  window.problem.camera = camera;
  const std::size_t first =
      keyframes.size() - std::min(static_cast<std::size_t>(kWindow), keyframes.size());
  std::vector<int> wanted;
  for (std::size_t k = first; k < keyframes.size(); ++k) {
    wanted.insert(wanted.end(), keyframes[k].landmarks.begin(), keyframes[k].landmarks.end());
  }
  std::sort(wanted.begin(), wanted.end());
  wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
  std::vector<int> shared(first, 0);  // landmarks that an older keyframe has in common
  for (const int id : wanted) {
    for (const KeyframeSighting& s : landmarks[static_cast<std::size_t>(id)].sightings) {
      if (s.keyframe < static_cast<int>(first)) ++shared[static_cast<std::size_t>(s.keyframe)];
    }
  }
  std::vector<int> older(first);
  std::iota(older.begin(), older.end(), 0);
  std::stable_sort(older.begin(), older.end(), [&](int a, int b) {
    return shared[static_cast<std::size_t>(a)] > shared[static_cast<std::size_t>(b)];
  });
  if (older.size() > kHeld) older.resize(kHeld);
  std::vector<int> slot(keyframes.size(), -1);
  const auto add_pose = [&](int k, bool fixed) {
    slot[static_cast<std::size_t>(k)] = static_cast<int>(window.keyframes.size());
    window.keyframes.push_back(k);
    window.problem.camera_from_world.push_back(
        keyframes[static_cast<std::size_t>(k)].camera_from_world);
    window.problem.fixed.push_back(fixed ? 1 : 0);
  };
  bool any_fixed = false;
  for (const int k : older) {
    if (shared[static_cast<std::size_t>(k)] < kLeastShared) continue;
    add_pose(k, true);
    any_fixed = true;
  }
  for (std::size_t k = first; k < keyframes.size(); ++k) {
    add_pose(static_cast<int>(k), k == 0 || (!any_fixed && k == first));
  }
  for (const int id : wanted) {
    const Landmark& landmark = landmarks[static_cast<std::size_t>(id)];
    if (!landmark.alive) continue;
    int count = 0;
    for (const KeyframeSighting& s : landmark.sightings) {
      count += slot[static_cast<std::size_t>(s.keyframe)] >= 0 ? 1 : 0;
    }
    if (count < 2) continue;
    const int point = static_cast<int>(window.landmarks.size());
    window.landmarks.push_back(id);
    window.problem.x_in_world.push_back(landmark.x_in_world);
    for (const KeyframeSighting& s : landmark.sightings) {
      const int pose = slot[static_cast<std::size_t>(s.keyframe)];
      if (pose >= 0) window.problem.sightings.push_back({pose, point, s.seen});
    }
  }
  return window;
}

void adjust(Window& window) {
  adjust_bundle(window.problem);
  for (const BundleSighting& s : window.problem.sightings) {
    if (squared_residual(window.problem, s) > kBadSquared) {
      window.bad.emplace_back(window.landmarks[static_cast<std::size_t>(s.point)],
                              window.keyframes[static_cast<std::size_t>(s.pose)]);
    }
  }
}

void put_back(const Window& window, std::vector<Keyframe>& keyframes,
              std::vector<Landmark>& landmarks) {
  std::vector<std::optional<Rigid3>> world_from_old_world(keyframes.size());
  for (std::size_t i = 0; i < window.keyframes.size(); ++i) {
    if (window.problem.fixed[i] != 0) continue;
    const auto k = static_cast<std::size_t>(window.keyframes[i]);
    Rigid3& pose = keyframes[k].camera_from_world;
    world_from_old_world[k] = window.problem.camera_from_world[i].inverse(Eigen::Isometry) * pose;
    pose = window.problem.camera_from_world[i];
  }
  std::vector<char> adjusted(landmarks.size(), 0);
  for (std::size_t j = 0; j < window.landmarks.size(); ++j) {
    const auto id = static_cast<std::size_t>(window.landmarks[j]);
    landmarks[id].x_in_world = window.problem.x_in_world[j];
    adjusted[id] = 1;
  }
  move_points(world_from_old_world, adjusted, keyframes, landmarks);
  for (const auto& [id, k] : window.bad) {
    Landmark& landmark = landmarks[static_cast<std::size_t>(id)];
    std::erase_if(landmark.sightings,
                  [k = k](const KeyframeSighting& s) { return s.keyframe == k; });
    if (landmark.sightings.size() < 2 || k == landmark.anchor) landmark.alive = false;
  }
}

void move_points(const std::vector<std::optional<Rigid3>>& world_from_old_world,
                 const std::vector<char>& done, const std::vector<Keyframe>& keyframes,
                 std::vector<Landmark>& landmarks) {
  for (std::size_t k = 0; k < keyframes.size(); ++k) {
    if (!world_from_old_world[k]) continue;
    for (const int id : keyframes[k].landmarks) {
      Landmark& landmark = landmarks[static_cast<std::size_t>(id)];
      if (done[static_cast<std::size_t>(id)] == 0 && landmark.anchor == static_cast<int>(k)) {
        landmark.x_in_world = *world_from_old_world[k] * landmark.x_in_world;
      }
    }
  }
}

}  // namespace palpable

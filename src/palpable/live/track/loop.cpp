#include "palpable/live/track/loop.h"

#include "palpable/live/track/picture_shift.h"
#include "palpable/live/track/window.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace palpable {
namespace {

// Number of landmarks shared with the newest keyframe from which an old keyframe is no candidate
// for a loop: it can be held in the newest one's window.
constexpr int kFewShared = 5;
constexpr int kTied = 15;           // shared landmarks from which two keyframes are tied
constexpr double kMostDrift = 0.1;  // largest plausible drift, as a share of the path length
constexpr double kLoopPx = 20;      // drift from which a loop is closed, as a shift of the picture

double turn_of(const Rigid3& T) { return Eigen::AngleAxisd(T.linear()).angle(); }

// Index of the keyframe with a frame number, or -1.
int index_of(const std::vector<Keyframe>& keyframes, int number) {
  const auto at = std::lower_bound(
      keyframes.begin(), keyframes.end(), number,
      [](const Keyframe& keyframe, int wanted) { return keyframe.number < wanted; });
  return at != keyframes.end() && at->number == number ? static_cast<int>(at - keyframes.begin())
                                                       : -1;
}

// The number of landmarks that each pair of keyframes shares. It is a full table, because a
// landmark can be seen from hundreds of keyframes and a tree would delay the frame.
class SharedLandmarks {
 public:
  explicit SharedLandmarks(const LandmarkMap& map)
      : keyframes_(map.keyframes.size()), counts_(keyframes_ * keyframes_, 0) {
    for (const Landmark& landmark : map.landmarks) {
      if (!landmark.alive) continue;
      for (std::size_t i = 0; i < landmark.sightings.size(); ++i) {
        for (std::size_t j = i + 1; j < landmark.sightings.size(); ++j) {
          ++of(landmark.sightings[i].keyframe, landmark.sightings[j].keyframe);
        }
      }
    }
  }
  [[nodiscard]] int& of(int a, int b) { return counts_[a * keyframes_ + b]; }

 private:
  std::size_t keyframes_;
  std::vector<int> counts_;  // (keyframes x keyframes)
};

}  // namespace

std::vector<int> loop_candidates(const LandmarkMap& map, int most) {
  const std::vector<Keyframe>& keyframes = map.keyframes;
  const int old = static_cast<int>(keyframes.size()) - kWindow;
  if (old <= 0) return {};
  std::vector<int> shared(old, 0);
  for (const int id : keyframes.back().landmarks) {
    for (const KeyframeSighting& s : map.landmarks[id].sightings) {
      if (s.keyframe < old) ++shared[s.keyframe];
    }
  }
  std::vector<std::pair<double, int>> order;
  for (int k = 0; k < old; ++k) {
    if (shared[k] >= kFewShared) continue;
    order.emplace_back(-likeness(keyframes.back().thumbnail, keyframes[k].thumbnail), k);
  }
  std::sort(order.begin(), order.end());
  std::vector<int> result;
  for (const auto& [unlike, k] : order) {
    if (std::ssize(result) < most) result.push_back(k);
  }
  return result;
}

std::optional<Rigid3> pose_by(const Loop& loop, const std::vector<Keyframe>& keyframes) {
  const int a = index_of(keyframes, loop.old_number);
  const int b = index_of(keyframes, loop.new_number);
  if (a < 0 || b < a) return std::nullopt;
  double way = 0, turn = 0;
  for (int k = a; k < b; ++k) {
    const Rigid3 motion =
        keyframes[k + 1].camera_from_world * keyframes[k].camera_from_world.inverse();
    way += motion.translation().norm();
    turn += turn_of(motion);
  }
  const Rigid3 by_loop = loop.new_from_old.camera_from_old * keyframes[a].camera_from_world;
  const Rigid3& now = keyframes[b].camera_from_world;
  // A rotation and a translation that shift the picture by the same number of px are hard to
  // distinguish, so drift of one may come from the other.
  const double depth = keyframes[b].median_depth;
  const double farthest = kMostDrift * (way + turn * depth);
  if ((by_loop.inverse().translation() - now.inverse().translation()).norm() > farthest ||
      turn_of(by_loop * now.inverse()) * depth > farthest) {
    return std::nullopt;
  }
  return by_loop;
}

std::optional<PoseGraph> graph_of(const TrackCamera& camera, const LandmarkMap& map,
                                  const Loop& loop) {
  const std::vector<Keyframe>& keyframes = map.keyframes;
  const int old_one = index_of(keyframes, loop.old_number);
  const int new_one = index_of(keyframes, loop.new_number);
  if (old_one < 0 || new_one <= old_one) return std::nullopt;
  PoseGraph graph;
  for (const Keyframe& keyframe : keyframes) {
    graph.camera_from_world.push_back(keyframe.camera_from_world);
  }
  const auto tie = [&](int a, int b, const Rigid3& b_from_a, int count) {
    const double sigma_turn = 1 / (camera.camera.fx_px * std::sqrt(static_cast<double>(count)));
    graph.ties.push_back({a, b, b_from_a, keyframes[b].median_depth * sigma_turn, sigma_turn});
  };
  SharedLandmarks shared(map);
  const int K = static_cast<int>(keyframes.size());
  // Each keyframe's pose was derived from the one before, even if no shared landmark is left.
  for (int k = 0; k + 1 < K; ++k) ++shared.of(k, k + 1);
  for (int a = 0; a < K; ++a) {
    for (int b = 0; b < K; ++b) {
      const int count = shared.of(a, b);
      if (count == 0 || (b != a + 1 && count < kTied)) continue;
      tie(a, b, graph.camera_from_world[b] * graph.camera_from_world[a].inverse(), count);
    }
  }
  tie(old_one, new_one, loop.new_from_old.camera_from_old, loop.new_from_old.agreeing);
  return graph;
}

void put_back(const PoseGraph& graph, LandmarkMap& map) {
  std::vector<std::optional<Rigid3>> world_from_old_world(map.keyframes.size());
  for (std::size_t k = 0; k < map.keyframes.size(); ++k) {
    Rigid3& pose = map.keyframes[k].camera_from_world;
    world_from_old_world[k] = graph.camera_from_world[k].inverse() * pose;
    pose = graph.camera_from_world[k];
  }
  std::vector<char> placed(map.landmarks.size(), 0);
  // A landmark whose anchor was removed moves with the oldest remaining keyframe that saw it.
  for (std::size_t i = 0; i < map.landmarks.size(); ++i) {
    Landmark& landmark = map.landmarks[i];
    if (!landmark.alive || landmark.anchor >= 0 || landmark.sightings.empty()) continue;
    const int k = landmark.sightings.front().keyframe;
    landmark.x_in_world = *world_from_old_world[k] * landmark.x_in_world;
    landmark.lost_anchor = landmark.lost_anchor * world_from_old_world[k]->inverse();
    placed[i] = 1;
  }
  move_landmarks(world_from_old_world, placed, map);
}

void forget_doubles(const TrackCamera& camera, const Loop& loop, LandmarkMap& map) {
  const int old = index_of(map.keyframes, loop.old_number);
  if (old < 0) return;
  const int first = static_cast<int>(map.keyframes.size()) - kWindow;
  for (Landmark& landmark : map.landmarks) {
    if (!landmark.alive || landmark.anchor < first || landmark.anchor <= old) continue;
    const Eigen::Vector3d x = map.keyframes[old].camera_from_world * landmark.x_in_world;
    if (!(x.z() > 0)) continue;
    const Eigen::Vector2d uv = camera.camera.project(x);
    if (uv.x() > 0 && uv.y() > 0 && uv.x() < camera.camera.width && uv.y() < camera.camera.height) {
      landmark.alive = false;
    }
  }
}

std::vector<Correction> close_loop(const TrackCamera& camera, const Loop& loop,
                                   const PoseGraph& adjusted, LandmarkMap& map) {
  std::vector<Rigid3> camera_from_drifted;
  for (const Keyframe& k : map.keyframes) camera_from_drifted.push_back(k.camera_from_world);
  put_back(adjusted, map);
  std::vector<Correction> corrections;
  for (std::size_t k = 0; k < map.keyframes.size(); ++k) {
    const Rigid3 world_from_camera = map.keyframes[k].camera_from_world.inverse(Eigen::Isometry);
    corrections.push_back({map.keyframes[k].number, world_from_camera * camera_from_drifted[k]});
  }
  forget_doubles(camera, loop, map);
  return corrections;
}

void LoopConfirmation::compare(const std::optional<Loop>& loop, const TrackCamera& camera,
                               double median_depth, const std::vector<Keyframe>& keyframes) {
  const std::optional<Rigid3> camera_from_world = loop ? pose_by(*loop, keyframes) : std::nullopt;
  const Rigid3& camera_from_drifted = keyframes.back().camera_from_world;
  const auto shift_px = [&](const Rigid3& a, const Rigid3& b) {
    return picture_shift_px(camera, median_depth, a, b);
  };
  if (!camera_from_world || shift_px(camera_from_drifted, *camera_from_world) < kLoopPx) {
    drifted_from_world_.reset();
    return;
  }
  if (drifted_from_world_ &&
      shift_px(camera_from_drifted * *drifted_from_world_, *camera_from_world) < kLoopPx) {
    confirmed_ = loop;
    drifted_from_world_.reset();
  } else {
    drifted_from_world_ = camera_from_drifted.inverse(Eigen::Isometry) * *camera_from_world;
  }
}

std::optional<Loop> LoopConfirmation::take_confirmed() {
  return std::exchange(confirmed_, std::nullopt);
}

void LoopConfirmation::clear() {
  drifted_from_world_.reset();
  confirmed_.reset();
}

}  // namespace palpable

#include "palpable/track/loop.h"

#include "palpable/track/window.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace palpable {
namespace {

constexpr int kHardly = 5;  // landmarks in common: the adjustment of the window asks for as many
constexpr int kTied = 15;   // landmarks in common that make a tie
constexpr double kMostDrift = 0.1;

double angle_of(const Rigid3& T) { return Eigen::AngleAxisd(T.linear()).angle(); }

int index_of(const std::vector<Keyframe>& keyframes, int number) {
  const auto at = std::lower_bound(
      keyframes.begin(), keyframes.end(), number,
      [](const Keyframe& keyframe, int wanted) { return keyframe.number < wanted; });
  return at != keyframes.end() && at->number == number ? static_cast<int>(at - keyframes.begin())
                                                       : -1;
}

}  // namespace

std::vector<int> loop_candidates(const std::vector<Keyframe>& keyframes,
                                 const std::vector<Landmark>& landmarks, int most) {
  const int old = static_cast<int>(keyframes.size()) - kWindow;
  if (old <= 0) return {};
  std::vector<int> shared(static_cast<std::size_t>(old), 0);
  for (const int id : keyframes.back().landmarks) {
    for (const KeyframeSighting& s : landmarks[static_cast<std::size_t>(id)].sightings) {
      if (s.keyframe < old) ++shared[static_cast<std::size_t>(s.keyframe)];
    }
  }
  std::vector<std::pair<double, int>> order;
  for (int k = 0; k < old; ++k) {
    if (shared[static_cast<std::size_t>(k)] >= kHardly) continue;
    order.emplace_back(
        -likeness(keyframes.back().thumbnail, keyframes[static_cast<std::size_t>(k)].thumbnail), k);
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
    const Rigid3 motion = keyframes[static_cast<std::size_t>(k) + 1].camera_from_world *
                          keyframes[static_cast<std::size_t>(k)].camera_from_world.inverse();
    way += motion.translation().norm();
    turn += angle_of(motion);
  }
  const Rigid3 by_loop =
      loop.new_from_old.camera_from_old * keyframes[static_cast<std::size_t>(a)].camera_from_world;
  const Rigid3& now = keyframes[static_cast<std::size_t>(b)].camera_from_world;
  // Between pictures a turn can be taken for a way of as many pixels, and the other way round.
  const double depth = keyframes[static_cast<std::size_t>(b)].median_depth;
  const double farthest = kMostDrift * (way + turn * depth);
  if ((by_loop.inverse().translation() - now.inverse().translation()).norm() > farthest ||
      angle_of(by_loop * now.inverse()) * depth > farthest) {
    return std::nullopt;
  }
  return by_loop;
}

std::optional<PoseGraph> graph_of(const TrackCamera& camera, const std::vector<Keyframe>& keyframes,
                                  const std::vector<Landmark>& landmarks, const Loop& loop) {
  const int old_one = index_of(keyframes, loop.old_number);
  const int new_one = index_of(keyframes, loop.new_number);
  if (old_one < 0 || new_one <= old_one) return std::nullopt;
  // Landmarks that two keyframes share, of the pair a, b at a K + b. A landmark may be seen from
  // hundreds: a table, since a tree would hold up the frame.
  const auto K = static_cast<int>(keyframes.size());
  std::vector<int> shared(keyframes.size() * keyframes.size(), 0);
  const auto count_of = [&](int a, int b) -> int& {
    return shared[static_cast<std::size_t>(a) * keyframes.size() + static_cast<std::size_t>(b)];
  };
  for (const Landmark& landmark : landmarks) {
    if (!landmark.alive) continue;
    for (std::size_t i = 0; i < landmark.sightings.size(); ++i) {
      for (std::size_t j = i + 1; j < landmark.sightings.size(); ++j) {
        ++count_of(landmark.sightings[i].keyframe, landmark.sightings[j].keyframe);
      }
    }
  }
  PoseGraph graph;
  for (const Keyframe& keyframe : keyframes) {
    graph.camera_from_world.push_back(keyframe.camera_from_world);
  }
  const auto tie = [&](int a, int b, const Rigid3& b_from_a, int count) {
    const double sigma_turn = 1 / (camera.camera.fx_px * std::sqrt(static_cast<double>(count)));
    const double depth = keyframes[static_cast<std::size_t>(b)].median_depth;
    graph.ties.push_back({a, b, b_from_a, depth * sigma_turn, sigma_turn});
  };
  for (int k = 0; k + 1 < K; ++k) {
    ++count_of(k, k + 1);  // one comes from the other, whatever has been forgotten since
  }
  for (int a = 0; a < K; ++a) {
    for (int b = 0; b < K; ++b) {
      const int count = count_of(a, b);
      if (count == 0 || (b != a + 1 && count < kTied)) continue;
      tie(a, b,
          graph.camera_from_world[static_cast<std::size_t>(b)] *
              graph.camera_from_world[static_cast<std::size_t>(a)].inverse(),
          count);
    }
  }
  tie(old_one, new_one, loop.new_from_old.camera_from_old, loop.new_from_old.agreeing);
  return graph;
}

void put_back(const PoseGraph& graph, std::vector<Keyframe>& keyframes,
              std::vector<Landmark>& landmarks) {
  std::vector<std::optional<Rigid3>> world_from_old_world(keyframes.size());
  for (std::size_t k = 0; k < keyframes.size(); ++k) {
    world_from_old_world[k] = graph.camera_from_world[k].inverse() * keyframes[k].camera_from_world;
    keyframes[k].camera_from_world = graph.camera_from_world[k];
  }
  std::vector<char> done(landmarks.size(), 0);
  // Whose anchor is forgotten goes with the oldest that is left of those that saw it.
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    Landmark& landmark = landmarks[i];
    if (!landmark.alive || landmark.anchor >= 0 || landmark.sightings.empty()) continue;
    const auto k = static_cast<std::size_t>(landmark.sightings.front().keyframe);
    landmark.x_in_world = *world_from_old_world[k] * landmark.x_in_world;
    landmark.lost_anchor = landmark.lost_anchor * world_from_old_world[k]->inverse();
    done[i] = 1;
  }
  move_points(world_from_old_world, done, keyframes, landmarks);
}

void forget_doubles(const TrackCamera& camera, const Loop& loop,
                    const std::vector<Keyframe>& keyframes, std::vector<Landmark>& landmarks) {
  const int old = index_of(keyframes, loop.old_number);
  if (old < 0) return;
  const int first = static_cast<int>(keyframes.size()) - kWindow;
  for (Landmark& landmark : landmarks) {
    if (!landmark.alive || landmark.anchor < first || landmark.anchor <= old) continue;
    const Eigen::Vector3d x =
        keyframes[static_cast<std::size_t>(old)].camera_from_world * landmark.x_in_world;
    if (!(x.z() > 0)) continue;
    const Eigen::Vector2d uv = camera.camera.project(x);
    if (uv.x() > 0 && uv.y() > 0 && uv.x() < camera.camera.width && uv.y() < camera.camera.height) {
      landmark.alive = false;
    }
  }
}

}  // namespace palpable

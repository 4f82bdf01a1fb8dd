#include "palpable/live/track/forgetting.h"

#include "palpable/common/base/contract.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

namespace palpable {
namespace {

constexpr int kFairlyTried = 10;        // searches after which a landmark is judged
constexpr double kLeastShare = 1 / 3.;  // smallest share of them in which it must agree
constexpr int kOthers = 3;              // other keyframes that must see a landmark to replace one
constexpr double kShared = 0.9;         // share of its landmarks that makes a keyframe redundant
constexpr int kRoom = 8;                // 1/8 of the map is freed at a time

bool is_useless(const Landmark& landmark) {
  const int tried = landmark.inlier + landmark.outlier + landmark.missed;
  return tried >= kFairlyTried && landmark.inlier < kLeastShare * tried;
}

double angle_of(const Rigid3& T) { return Eigen::AngleAxisd(T.linear()).angle(); }

// Marks landmarks and keyframes to be removed, and removes them at the end.
class Room {
 public:
  Room(const MapLimits& limits, int newest, LandmarkMap& map)
      : map_(map),
        most_keyframes_(limits.keyframes - limits.keyframes / kRoom),
        most_landmarks_(limits.landmarks - limits.landmarks / kRoom),
        old_(std::max(static_cast<int>(map.keyframes.size()) - newest, 0)),
        stays_(map.keyframes.size(), 1),
        seen_in_(map.landmarks.size(), 0),
        keyframes_left_(static_cast<int>(map.keyframes.size())) {}

  // Step 1 of make_room().
  void give_up_useless_landmarks() {
    for (std::size_t i = 0; i < map_.landmarks.size(); ++i) {
      Landmark& landmark = map_.landmarks[i];
      // Landmarks seen by the newest keyframes may be too new to be judged.
      const bool is_new = !landmark.sightings.empty() && landmark.sightings.back().keyframe >= old_;
      if (landmark.alive && !is_new && is_useless(landmark)) landmark.alive = false;
      if (!landmark.alive) continue;
      seen_in_[i] = static_cast<int>(landmark.sightings.size());
      ++landmarks_left_;
    }
  }

  // Step 2.
  void give_up_shared_keyframes() {
    for (int k = 0; k < old_ && keyframes_left_ > most_keyframes_; ++k) {
      int alive = 0, shared = 0;
      for (const int id : map_.keyframes[k].landmarks) {
        alive += seen_in_[id] > 0 ? 1 : 0;
        shared += seen_in_[id] > kOthers ? 1 : 0;
      }
      if (shared >= kShared * alive) give_up(k);
    }
  }

  // Step 3.
  void give_up_far_keyframes(const Rigid3& camera_from_world) {
    std::vector<double> far(old_);
    std::vector<int> order(old_);
    std::iota(order.begin(), order.end(), 0);
    for (int k = 0; k < old_; ++k) {
      const Keyframe& keyframe = map_.keyframes[k];
      const Rigid3 keyframe_from_camera =
          keyframe.camera_from_world * camera_from_world.inverse(Eigen::Isometry);
      far[k] = keyframe_from_camera.translation().norm() / keyframe.median_depth +
               angle_of(keyframe_from_camera);
    }
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return far[a] > far[b]; });
    for (const int k : order) {
      if (keyframes_left_ <= most_keyframes_ && landmarks_left_ <= most_landmarks_) return;
      if (stays_[k] != 0) give_up(k);
    }
  }

  // Removes the marked landmarks and keyframes.
  void clear() {
    std::vector<int> new_index(map_.keyframes.size(), -1);  // -1: removed
    int next = 0;
    for (std::size_t k = 0; k < new_index.size(); ++k) {
      if (stays_[k] != 0) new_index[k] = next++;
    }
    clear_landmarks(new_index);
    clear_keyframes(new_index);
    map_.keyframes.erase(map_.keyframes.begin() + next, map_.keyframes.end());
  }

 private:
  void give_up(int k) {
    stays_[k] = 0;
    --keyframes_left_;
    for (const int id : map_.keyframes[k].landmarks) {
      // An adjustment may have dropped the sighting.
      const auto& sightings = map_.landmarks[id].sightings;
      const bool counted = std::any_of(sightings.begin(), sightings.end(),
                                       [k](const KeyframeSighting& s) { return s.keyframe == k; });
      if (seen_in_[id] > 0 && counted && --seen_in_[id] == 0) --landmarks_left_;
    }
  }

  void clear_landmarks(const std::vector<int>& new_index) {
    map_.free_slots.clear();
    for (std::size_t i = 0; i < map_.landmarks.size(); ++i) {
      Landmark& landmark = map_.landmarks[i];
      if (seen_in_[i] == 0) {
        landmark.alive = false;
        landmark.sightings.clear();
        map_.free_slots.push_back(static_cast<int>(i));
        continue;
      }
      std::erase_if(landmark.sightings, [&](KeyframeSighting& s) {
        s.keyframe = new_index[s.keyframe];
        return s.keyframe < 0;
      });
      if (landmark.anchor < 0) continue;
      const Keyframe& anchor = map_.keyframes[landmark.anchor];
      landmark.anchor = new_index[landmark.anchor];
      if (landmark.anchor < 0) landmark.lost_anchor = anchor.camera_from_world;
    }
  }

  void clear_keyframes(const std::vector<int>& new_index) {
    for (int k = 0; k < static_cast<int>(new_index.size()); ++k) {
      if (new_index[k] < 0) continue;
      std::erase_if(map_.keyframes[k].landmarks, [&](int id) { return seen_in_[id] == 0; });
      if (new_index[k] != k) map_.keyframes[new_index[k]] = std::move(map_.keyframes[k]);
    }
  }

  LandmarkMap& map_;
  int most_keyframes_;
  int most_landmarks_;
  int old_;                  // number of keyframes before the newest
  std::vector<char> stays_;  // (keyframes) 0: to be removed
  std::vector<int>
      seen_in_;  // (landmarks) number of staying keyframes that see it; 0: to be removed
  int keyframes_left_;
  int landmarks_left_ = 0;
};

}  // namespace

void make_room(const Rigid3& camera_from_world, const MapLimits& limits, int newest,
               LandmarkMap& map) {
  PALPABLE_EXPECT(newest >= 1 && limits.keyframes >= 2 * newest,
                  "the limit of keyframes is at least twice the number that is kept");
  Room room(limits, newest, map);
  room.give_up_useless_landmarks();
  room.give_up_shared_keyframes();
  room.give_up_far_keyframes(camera_from_world);
  room.clear();
}

}  // namespace palpable

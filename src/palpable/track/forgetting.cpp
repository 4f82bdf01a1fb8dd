#include "palpable/track/forgetting.h"

#include "palpable/base/contract.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace palpable {
namespace {

constexpr int kFairlyTried = 10;        // times looked for before a landmark is judged
constexpr double kLeastShare = 1 / 3.;  // of them in which it agreed
constexpr int kOthers = 3;              // keyframes that make one more unnecessary
constexpr double kShared = 0.9;         // of its landmarks
constexpr int kRoom = 8;                // one part in so many is freed at a time

bool is_useless(const Landmark& landmark) {
  const int tried = landmark.inlier + landmark.outlier + landmark.missed;
  return tried >= kFairlyTried && landmark.inlier < kLeastShare * tried;
}

class Room {
 public:
  Room(const MapLimits& limits, int newest, std::vector<Keyframe>& keyframes,
       std::vector<Landmark>& landmarks)
      : keyframes_(keyframes),
        landmarks_(landmarks),
        most_keyframes_(limits.keyframes - limits.keyframes / kRoom),
        most_landmarks_(limits.landmarks - limits.landmarks / kRoom),
        old_(std::max(static_cast<int>(keyframes.size()) - newest, 0)),
        stays_(keyframes.size(), 1),
        seen_in_(landmarks.size(), 0),
        keyframes_left_(static_cast<int>(keyframes.size())) {
    for (std::size_t i = 0; i < landmarks.size(); ++i) {
      Landmark& landmark = landmarks[i];
      // What the newest keyframes see may be new.
      const bool is_new = !landmark.sightings.empty() && landmark.sightings.back().keyframe >= old_;
      if (landmark.alive && !is_new && is_useless(landmark)) landmark.alive = false;
      if (!landmark.alive) continue;
      seen_in_[i] = static_cast<int>(landmark.sightings.size());
      ++landmarks_left_;
    }
  }

  void give_up_shared() {
    for (int k = 0; k < old_ && keyframes_left_ > most_keyframes_; ++k) {
      int alive = 0, shared = 0;
      for (const int id : keyframes_[static_cast<std::size_t>(k)].landmarks) {
        const int seen_in = seen_in_[static_cast<std::size_t>(id)];
        alive += seen_in > 0 ? 1 : 0;
        shared += seen_in > kOthers ? 1 : 0;
      }
      if (shared >= kShared * alive) give_up(k);
    }
  }

  void give_up_far(const Rigid3& camera_from_world) {
    std::vector<double> far(static_cast<std::size_t>(old_));
    std::vector<int> order(far.size());
    std::iota(order.begin(), order.end(), 0);
    for (std::size_t k = 0; k < far.size(); ++k) {
      const Rigid3 motion =
          keyframes_[k].camera_from_world * camera_from_world.inverse(Eigen::Isometry);
      far[k] = motion.translation().norm() / keyframes_[k].median_depth +
               Eigen::AngleAxisd(motion.linear()).angle();
    }
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
      return far[static_cast<std::size_t>(a)] > far[static_cast<std::size_t>(b)];
    });
    for (const int k : order) {
      if (keyframes_left_ <= most_keyframes_ && landmarks_left_ <= most_landmarks_) return;
      if (stays_[static_cast<std::size_t>(k)] != 0) give_up(k);
    }
  }

  // Takes out what was given up.
  void clear(std::vector<int>& free_slots) {
    std::vector<int> index(keyframes_.size(), -1);  // of those that stay
    int next = 0;
    for (std::size_t k = 0; k < index.size(); ++k) {
      if (stays_[k] != 0) index[k] = next++;
    }
    free_slots.clear();
    for (std::size_t i = 0; i < landmarks_.size(); ++i) {
      Landmark& landmark = landmarks_[i];
      if (seen_in_[i] == 0) {
        landmark.alive = false;
        landmark.sightings.clear();
        free_slots.push_back(static_cast<int>(i));
        continue;
      }
      std::erase_if(landmark.sightings, [&](KeyframeSighting& s) {
        s.keyframe = index[static_cast<std::size_t>(s.keyframe)];
        return s.keyframe < 0;
      });
      if (landmark.anchor < 0) continue;
      const auto anchor = static_cast<std::size_t>(landmark.anchor);
      landmark.anchor = index[anchor];
      if (landmark.anchor < 0) landmark.lost_anchor = keyframes_[anchor].camera_from_world;
    }
    for (std::size_t k = 0; k < index.size(); ++k) {
      if (index[k] < 0) continue;
      std::erase_if(keyframes_[k].landmarks,
                    [&](int id) { return seen_in_[static_cast<std::size_t>(id)] == 0; });
      if (index[k] != static_cast<int>(k)) {
        keyframes_[static_cast<std::size_t>(index[k])] = std::move(keyframes_[k]);
      }
    }
    keyframes_.erase(keyframes_.begin() + next, keyframes_.end());
  }

 private:
  void give_up(int k) {
    stays_[static_cast<std::size_t>(k)] = 0;
    --keyframes_left_;
    for (const int id : keyframes_[static_cast<std::size_t>(k)].landmarks) {
      const auto i = static_cast<std::size_t>(id);
      // An adjustment may have taken the sighting away again.
      const auto& sightings = landmarks_[i].sightings;
      const bool counted = std::any_of(sightings.begin(), sightings.end(),
                                       [k](const KeyframeSighting& s) { return s.keyframe == k; });
      if (seen_in_[i] > 0 && counted && --seen_in_[i] == 0) --landmarks_left_;
    }
  }

  std::vector<Keyframe>& keyframes_;
  std::vector<Landmark>& landmarks_;
  int most_keyframes_;
  int most_landmarks_;
  int old_;                   // keyframes before the newest
  std::vector<char> stays_;   // (keyframes)
  std::vector<int> seen_in_;  // (landmarks) keyframes that stay; 0: it goes
  int keyframes_left_;
  int landmarks_left_ = 0;
};

}  // namespace

void make_room(const Rigid3& camera_from_world, const MapLimits& limits, int newest,
               std::vector<Keyframe>& keyframes, std::vector<Landmark>& landmarks,
               std::vector<int>& free_slots) {
  PALPABLE_EXPECT(newest >= 1 && limits.keyframes >= 2 * newest,
                  "the limit of keyframes is twice what has to stay, at least");
  Room room(limits, newest, keyframes, landmarks);
  room.give_up_shared();
  room.give_up_far(camera_from_world);
  room.clear(free_slots);
}

}  // namespace palpable

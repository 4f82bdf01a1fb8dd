#include "palpable/live/track/forgetting.h"

#include "palpable/common/base/contract.h"
#include "tests/support/test.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <vector>

namespace palpable {
namespace {

Rigid3 at(double x) { return Rigid3(Eigen::Translation3d(-x, 0, 0)); }  // camera_from_world

// Keyframes along a line, 0.1 m apart. Each adds `own` new landmarks, which `following` later
// keyframes see, too.
struct Walk : LandmarkMap {
  Walk(int count, int own, int following) {
    for (int k = 0; k < count; ++k) {
      Keyframe keyframe;
      keyframe.number = 10 * k;
      keyframe.camera_from_world = at(0.1 * k);
      keyframes.push_back(keyframe);
      for (int i = 0; i < own; ++i) {
        Landmark landmark;
        landmark.anchor = k;
        landmark.x_in_world = {0.1 * k, 0.01 * i, 1};
        landmark.inlier = 20;
        landmarks.push_back(landmark);
      }
    }
    for (int k = 0; k < count; ++k) {
      for (int s = std::max(k - following, 0); s <= k; ++s) {
        for (int i = 0; i < own; ++i) see(k, s * own + i);
      }
    }
  }
  void see(int k, int id) {
    landmarks[id].sightings.push_back({k, {}});
    keyframes[k].landmarks.push_back(id);
  }
  [[nodiscard]] std::vector<int> numbers() const {
    std::vector<int> result;
    for (const Keyframe& k : keyframes) result.push_back(k.number);
    return result;
  }
  [[nodiscard]] int alive() const {
    return static_cast<int>(std::count_if(landmarks.begin(), landmarks.end(),
                                          [](const Landmark& l) { return l.alive; }));
  }
  // Checks that the indices that are left are consistent.
  void check() const {
    for (std::size_t i = 0; i < landmarks.size(); ++i) {
      const bool is_free =
          std::find(free_slots.begin(), free_slots.end(), static_cast<int>(i)) != free_slots.end();
      CHECK(is_free == !landmarks[i].alive);
      CHECK(is_free == landmarks[i].sightings.empty());
      for (const KeyframeSighting& s : landmarks[i].sightings) {
        REQUIRE((s.keyframe >= 0 && s.keyframe < static_cast<int>(keyframes.size())));
        const auto& seen = keyframes[s.keyframe].landmarks;
        CHECK(std::count(seen.begin(), seen.end(), static_cast<int>(i)) == 1);
      }
      if (!is_free) CHECK(landmarks[i].anchor < static_cast<int>(keyframes.size()));
    }
    for (std::size_t k = 0; k < keyframes.size(); ++k) {
      if (k > 0) CHECK(keyframes[k - 1].number < keyframes[k].number);
      for (const int id : keyframes[k].landmarks) { CHECK(landmarks[id].alive); }
    }
  }
};

TEST_CASE("a map with room for everything gives up only what is dead or of no use",
          "[track][forgetting]") {
  Walk walk(10, 5, 2);
  walk.landmarks[3].alive = false;
  walk.landmarks[4].inlier = 4;  // of 14: less than a third
  walk.landmarks[4].missed = 10;
  walk.landmarks[6].inlier = 0;  // but it was searched only nine times
  walk.landmarks[6].missed = 9;
  walk.landmarks[47].inlier = 0;  // seen by one of the newest keyframes
  walk.landmarks[47].missed = 20;
  make_room(at(0.9), {100, 1000}, 3, walk);
  CHECK(walk.free_slots == std::vector<int>{3, 4});
  CHECK(walk.keyframes.size() == 10);
  CHECK(walk.keyframes[0].landmarks == std::vector<int>{0, 1, 2});
  walk.check();
}

TEST_CASE(
    "too many landmarks: the keyframes go that are farthest from the camera, and with them "
    "what they alone have seen",
    "[track][forgetting]") {
  Walk walk(24, 10, 2);  // 240 landmarks
  // The camera is back at the sixth keyframe, and 175 landmarks may be left. The last ones of the
  // old keyframes are removed, each with its own landmarks.
  make_room(at(0.5), {100, 200}, 3, walk);
  CHECK(walk.alive() == 170);
  CHECK(walk.numbers() ==
        std::vector<int>{0, 10, 20, 30, 40, 50, 60, 70, 80, 90, 100, 110, 210, 220, 230});
  // The landmarks of the thirteenth keyframe are removed, those before it and some later ones not.
  CHECK_FALSE(walk.landmarks[120].alive);
  CHECK(walk.landmarks[119].alive);
  CHECK(walk.landmarks[190].alive);
  CHECK(walk.landmarks[190].anchor == -1);
  walk.check();
}

TEST_CASE("a keyframe that looks elsewhere is farther than one a step away",
          "[track][forgetting]") {
  Walk walk(16, 1, 0);
  for (Keyframe& k : walk.keyframes) k.camera_from_world = at(0);
  walk.keyframes[2].camera_from_world = Rigid3(Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitY()));
  walk.keyframes[5].camera_from_world = at(0.5);
  walk.keyframes[5].median_depth = 2;  // m; the keyframe is 0.25 of this away
  make_room(at(0), {16, 15}, 4, walk);
  // 14 are left: first the one that looks elsewhere is removed, then the one that stands apart.
  std::vector<int> expected;
  for (int k = 0; k < 16; ++k) {
    if (k != 2 && k != 5) expected.push_back(10 * k);
  }
  CHECK(walk.numbers() == expected);
  walk.check();
}

TEST_CASE(
    "too many keyframes: those go first that others make unnecessary; their landmarks stay, "
    "with the anchor's pose",
    "[track][forgetting]") {
  Walk walk(16, 4, 0);
  // All landmarks of keyframes 3 and 6 are seen by four others.
  for (const int k : {3, 6}) {
    for (int i = 0; i < 4; ++i) {
      for (const int other : {8, 9, 10, 11}) walk.see(other, 4 * k + i);
    }
  }
  make_room(at(1.5), {16, 1000}, 4, walk);
  const std::vector<int> left = walk.numbers();
  CHECK(left.size() == 14);
  CHECK(std::count(left.begin(), left.end(), 30) == 0);
  CHECK(std::count(left.begin(), left.end(), 60) == 0);
  CHECK(walk.free_slots.empty());
  CHECK(walk.landmarks[12].anchor == -1);
  CHECK(anchor_pose(walk.landmarks[12], walk.keyframes).isApprox(at(0.3)));
  CHECK(anchor_pose(walk.landmarks[60], walk.keyframes).isApprox(at(1.5)));
  CHECK(walk.landmarks[12].sightings.size() == 4);
  walk.check();
}

TEST_CASE("room made twice, the second time in what is left", "[track][forgetting]") {
  Walk walk(40, 6, 3);
  make_room(at(3.9), {20, 150}, 7, walk);
  walk.check();
  CHECK(walk.keyframes.size() <= 18);
  CHECK(walk.keyframes.back().number == 390);
  make_room(at(3.9), {16, 60}, 7, walk);
  walk.check();
  CHECK(walk.alive() <= 60);
  CHECK_THROWS_AS(make_room(at(0), {13, 60}, 7, walk), ContractViolation);
}

}  // namespace
}  // namespace palpable

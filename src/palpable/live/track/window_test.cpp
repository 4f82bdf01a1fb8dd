#include "palpable/live/track/window.h"

#include "tests/support/test.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace palpable {
namespace {

using test::tolerance;

const TrackCamera kCamera{{640, 360, 350, 345, 319.5, 179.5}, 0.063};
constexpr int kCount = 16;     // keyframes
constexpr int kOwn = 12;       // landmarks that each brings
constexpr int kFollowing = 4;  // later keyframes that see them too

Rigid3 truth(int k) {
  return Rigid3(Eigen::AngleAxisd(0.02 * k, Eigen::Vector3d::UnitY())) *
         Eigen::Translation3d(-0.05 * k, 0, 0);
}

// A walk with exact sightings, so that an adjustment changes nothing.
struct Walk : LandmarkMap {
  Walk() {
    for (int k = 0; k < kCount; ++k) {
      Keyframe keyframe;
      keyframe.camera_from_world = truth(k);
      keyframes.push_back(keyframe);
      for (int i = 0; i < kOwn; ++i) {
        Landmark landmark;
        landmark.anchor = k;
        const int column = i % 4, row = i / 4;
        const double u = 120 + 130 * column, v = 60 + 110 * row, Z = 1 + 0.1 * (i % 5);
        landmark.x_in_world = truth(k).inverse(Eigen::Isometry) * kCamera.camera.unproject(u, v, Z);
        landmarks.push_back(landmark);
      }
      for (int from = std::max(k - kFollowing, 0); from <= k; ++from) {
        for (int i = 0; i < kOwn; ++i) see(k, from * kOwn + i);
      }
    }
  }
  void see(int k, int id) {
    Sighting seen;
    seen.uvd = kCamera.see(truth(k) * landmarks[id].x_in_world);
    seen.sigma = 0.3;
    seen.sigma_d = 0.25;
    landmarks[id].sightings.push_back({k, seen});
    keyframes[k].landmarks.push_back(id);
  }
};

constexpr int kFirst = kCount - kWindow;  // 9

TEST_CASE("the window is the last keyframes, tied to older ones that see the same", "[track]") {
  Walk walk;
  const AdjustmentWindow window = window_of(kCamera, walk);
  // The window sees the landmarks that keyframes 5 and later have added. Keyframe 8 has seen most
  // of these, 48; keyframe 5 has seen its own 12, and keyframe 4 none.
  REQUIRE(window.keyframes.size() == 4U + kWindow);
  CHECK(std::vector<int>(window.keyframes.begin(), window.keyframes.begin() + 4) ==
        std::vector<int>{8, 7, 6, 5});
  for (std::size_t i = 0; i < window.keyframes.size(); ++i) {
    CHECK((window.problem.fixed[i] != 0) == (window.keyframes[i] < kFirst));
    if (i >= 4) CHECK(window.keyframes[i] == kFirst + static_cast<int>(i) - 4);
    CHECK(window.problem.camera_from_world[i].matrix() == truth(window.keyframes[i]).matrix());
  }
  // The landmarks of keyframes 5 to 14; those of the newest keyframe were seen only once.
  REQUIRE(window.landmarks.size() == 10U * kOwn);
  CHECK(window.landmarks.front() == 5 * kOwn);
  CHECK(window.landmarks.back() == 15 * kOwn - 1);

  // In a young map the first keyframe defines the world frame and is held fixed.
  Walk young;
  young.keyframes.resize(3);
  for (Landmark& landmark : young.landmarks) {
    std::erase_if(landmark.sightings, [](const KeyframeSighting& s) { return s.keyframe >= 3; });
  }
  const AdjustmentWindow first = window_of(kCamera, young);
  CHECK(first.keyframes == std::vector<int>{0, 1, 2});
  CHECK(first.problem.fixed == std::vector<char>{1, 0, 0});
  CHECK(first.landmarks.size() == 2U * kOwn);
}

TEST_CASE("a window that shares nothing with older keyframes is held by its own first one",
          "[track]") {
  Walk walk;
  for (int k = 0; k < kFirst; ++k) walk.keyframes[k].landmarks.clear();
  for (Landmark& landmark : walk.landmarks) {
    std::erase_if(landmark.sightings,
                  [](const KeyframeSighting& s) { return s.keyframe < kFirst; });
  }
  const AdjustmentWindow window = window_of(kCamera, walk);
  CHECK(window.keyframes == std::vector<int>{9, 10, 11, 12, 13, 14, 15});
  CHECK(window.problem.fixed == std::vector<char>{1, 0, 0, 0, 0, 0, 0});
}

TEST_CASE("an adjusted window has its keyframes and landmarks where they were", "[track]") {
  const Walk walk;
  Walk off = walk;
  for (int k = kFirst; k < kCount; ++k) {
    const Twist drift = (k - kFirst + 1) * (Twist() << 2e-3, -1e-3, 1e-3, 0, 1e-3, 0).finished();
    off.keyframes[k].camera_from_world = moved_by(drift, truth(k));
    // Each keyframe's own landmarks were placed by its pose.
    for (int i = k * kOwn; i < (k + 1) * kOwn; ++i) {
      off.landmarks[i].x_in_world =
          off.keyframes[k].camera_from_world.inverse() * truth(k) * walk.landmarks[i].x_in_world;
    }
  }
  AdjustmentWindow window = window_of(kCamera, off);
  adjust(window);
  CHECK(window.bad.empty());
  put_back(window, off);
  for (int k = 0; k < kCount; ++k) {
    INFO("keyframe " << k);
    CHECK((off.keyframes[k].camera_from_world.matrix() - truth(k).matrix()).norm() <=
          tolerance(1e-6, "sightings are exact; the last of ten steps is smaller than this"));
  }
  // Those of the newest keyframe are not in the window: they moved with their anchor.
  for (std::size_t i = 0; i < walk.landmarks.size(); ++i) {
    CHECK((off.landmarks[i].x_in_world - walk.landmarks[i].x_in_world).norm() <=
          tolerance(1e-5, "as the poses; ten times for points at 1 m with 22 px of disparity"));
  }
}

TEST_CASE("a sighting that does not agree is dropped; a landmark that keeps too few is given up",
          "[track]") {
  Walk walk;
  // Errors of 10 px, 33 sigma, in one of five sightings, in one of two, and in the first of five,
  // which is in the keyframe from whose picture the patch was cut.
  const auto spoil = [&](int id, int s) {
    walk.landmarks[id].sightings[s].seen.uvd.x() += 10;
    return std::pair{id, walk.landmarks[id].sightings[s].keyframe};
  };
  const int five = 10 * kOwn, two = 14 * kOwn, anchored = 10 * kOwn + 5;
  const std::vector<std::pair<int, int>> bad = {spoil(five, 2), spoil(anchored, 0), spoil(two, 1)};
  AdjustmentWindow window = window_of(kCamera, walk);
  adjust(window);
  // If there are only two sightings, either one may be wrong.
  std::vector<std::pair<int, int>> found = window.bad;
  std::erase(found, std::pair{two, 14});
  CHECK(found == bad);
  put_back(window, walk);
  CHECK(walk.landmarks[five].alive);
  CHECK(walk.landmarks[five].sightings.size() == 4);
  CHECK(std::none_of(walk.landmarks[five].sightings.begin(), walk.landmarks[five].sightings.end(),
                     [](const KeyframeSighting& s) { return s.keyframe == 12; }));
  CHECK_FALSE(walk.landmarks[anchored].alive);
  CHECK_FALSE(walk.landmarks[two].alive);
  CHECK(walk.count_alive() == kCount * kOwn - 2);
}

TEST_CASE("with another disparity error all lengths of the window change, older ones' too",
          "[track]") {
  // Disparities are 1 px too small, at 16 to 22 px. The map was made without knowing that.
  constexpr double kError = -1, kLonger = 1.05;
  Walk walk;
  for (Keyframe& keyframe : walk.keyframes) { keyframe.camera_from_world.translation() *= kLonger; }
  for (Landmark& landmark : walk.landmarks) {
    for (KeyframeSighting& s : landmark.sightings) { s.seen.uvd.z() += kError; }
    const Rigid3& anchor = walk.keyframes[landmark.anchor].camera_from_world;
    landmark.x_in_world =
        anchor.inverse(Eigen::Isometry) * kCamera.point(landmark.sightings.front().seen.uvd);
  }
  AdjustmentWindow window = window_of(kCamera, walk);
  adjust_with_error(window, kError);
  TrackCamera mended = kCamera;
  mended.disparity_error_px = kError;
  CHECK(window.problem.camera == mended);
  put_back(window, walk);
  const auto way = [](const Rigid3& a, const Rigid3& b) {
    return (a * b.inverse(Eigen::Isometry)).translation().norm();
  };
  // From the oldest keyframe of the window, which is held, to the newest.
  const double true_way = way(truth(5), truth(kCount - 1));
  CHECK(std::abs(
            way(walk.keyframes[5].camera_from_world, walk.keyframes[kCount - 1].camera_from_world) -
            true_way) <= tolerance(1e-3, "where the adjustment counts as converged") * true_way);
  // Landmarks that only the newest keyframe has seen were not adjusted.
  for (int i = 0; i < kOwn; ++i) {
    const Landmark& landmark = walk.landmarks[(kCount - 1) * kOwn + i];
    REQUIRE(landmark.sightings.size() == 1);
    const Eigen::Vector3d x = walk.keyframes[kCount - 1].camera_from_world * landmark.x_in_world;
    CHECK((mended.see(x) - landmark.sightings.front().seen.uvd).norm() <=
          tolerance(1e-9, "px, rounding"));
  }
}

TEST_CASE("landmarks move with their anchor, unless they have a place already", "[track]") {
  Walk walk;
  const std::vector<Landmark> before = walk.landmarks;
  std::vector<std::optional<Rigid3>> moved(kCount);
  moved[3] = Rigid3(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX()) *
                    Eigen::Translation3d(0.1, 0.2, 0.3));
  std::vector<char> placed(before.size(), 0);
  placed[3 * kOwn + 1] = 1;
  move_landmarks(moved, placed, walk);
  for (int i = 0; i < static_cast<int>(before.size()); ++i) {
    const bool moves = i / kOwn == 3 && i != 3 * kOwn + 1;
    const Eigen::Vector3d expected =
        moves ? *moved[3] * before[i].x_in_world : before[i].x_in_world;
    CHECK((walk.landmarks[i].x_in_world - expected).norm() == 0.0);
  }
}

}  // namespace
}  // namespace palpable

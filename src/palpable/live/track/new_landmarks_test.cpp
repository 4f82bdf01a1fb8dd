#include "palpable/live/track/new_landmarks.h"

#include "tests/support/noise_wall.h"
#include "tests/support/test.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace palpable {
namespace {

using test::kNoiseWallCamera;
using test::kNoiseWallZ;
using test::kPxPerMetre;
using test::standing_at;
using test::tolerance;
using test::WallMap;
using test::WallView;

constexpr int kFrame = 17;  // frames so far

// The second view: 6 px beside the first, and a little turned.
const Rigid3 kPose =
    Eigen::AngleAxisd(0.02, Eigen::Vector3d::UnitY()) * standing_at(6 / kPxPerMetre, 0.01, 0.03);
const WallView& second_view() {
  static const WallView view(kPose);
  return view;
}

// Enters a keyframe at `camera_from_world`, with its new landmarks.
void keep(const TrackerSettings& settings, const Rigid3& camera_from_world, const WallView& view,
          const TrackerFrame& frame, const PoseSearch& seen, LandmarkMap& map) {
  Keyframe keyframe;
  keyframe.camera_from_world = camera_from_world;
  map.keyframes.push_back(keyframe);
  NewLandmarks().add({settings, view.pyramid, map}, frame, seen, kFrame, map);
}

// The landmarks of one keyframe at kPose that has seen no old ones.
LandmarkMap first_keyframe(const TrackerSettings& settings, const TrackerFrame& frame) {
  LandmarkMap map;
  keep(settings, kPose, second_view(), frame, PoseSearch(settings), map);
  return map;
}

TEST_CASE("corners of the picture become landmarks that lie on the wall", "[track]") {
  const LandmarkMap map = first_keyframe(test::noise_wall_settings(), second_view().frame);
  CHECK(map.landmarks.size() > 100);
  CHECK(map.keyframes[0].landmarks.size() == map.landmarks.size());
  for (const Landmark& landmark : map.landmarks) {
    CHECK(std::abs(landmark.x_in_world.z() - kNoiseWallZ) <=
          tolerance(0.01, "a tenth of a pixel of disparity, of which 13.65 px are 1.2 m"));
    const Eigen::Vector3d truth = test::wall_at(kPose, landmark.uv.x(), landmark.uv.y()).second;
    CHECK((landmark.x_in_world - truth).head<2>().norm() <=
          tolerance(0.01, "the ray is known, so x and y are off by at most as much as Z"));
    CHECK(landmark.anchor == 0);
    CHECK(landmark.last_frame == kFrame);
    CHECK((landmark.sightings.size() == 1 && landmark.sightings[0].keyframe == 0));
    CHECK(landmark.sightings[0].seen.uvd.head<2>() == landmark.uv);
    // The camera is turned by 0.02 rad about Y, so 1/Z grows by sin(0.02) / (f Z) per px in x.
    const double expected = (1 / test::wall_at(kPose, landmark.uv.x() + 1, landmark.uv.y()).first) -
                            (1 / test::wall_at(kPose, landmark.uv.x(), landmark.uv.y()).first);
    CHECK(std::abs(landmark.slope.x() - expected) <=
          tolerance(2e-8, "two floats of 1 / 1.2 m, each rounded by 5e-8, over 8 px"));
    CHECK(landmark.look.levels[0].usable);
  }
}

TEST_CASE("no landmark is made where something moves or where the depth is not measured alike",
          "[track]") {
  const WallView& view = second_view();
  const int half = view.depth.width() / 2;
  const auto in_left_half = [&](const LandmarkMap& map) {
    return std::count_if(map.landmarks.begin(), map.landmarks.end(),
                         [&](const Landmark& landmark) { return landmark.uv.x() < half - 2; });
  };
  const TrackerSettings settings = test::noise_wall_settings();
  CHECK(in_left_half(first_keyframe(settings, view.frame)) > 40);

  MaskImage moving(view.depth.width(), view.depth.height());
  DepthImage nearer = view.depth;
  for (int y = 0; y < view.depth.height(); ++y) {
    for (int x = 0; x < half; ++x) {
      moving(x, y) = 255;
      // An error of 2 px of disparity: more than the 1.5 px allowed, less than the 3 px searched.
      const double d = kNoiseWallCamera.camera.fx_px * kNoiseWallCamera.baseline /
                       static_cast<double>(view.depth(x, y));
      nearer(x, y) = static_cast<float>(static_cast<double>(view.depth(x, y)) * d / (d + 2));
    }
  }
  TrackerFrame frame = view.frame;
  frame.moving = &moving;
  LandmarkMap map = first_keyframe(settings, frame);
  CHECK(in_left_half(map) == 0);
  CHECK(map.landmarks.size() > 40);
  frame = view.frame;
  frame.depth = &nearer;
  map = first_keyframe(settings, frame);
  CHECK(in_left_half(map) == 0);
  CHECK(map.landmarks.size() > 40);
}

TEST_CASE("a keyframe brings no more landmarks than the map has room for", "[track]") {
  TrackerSettings settings = test::noise_wall_settings();
  settings.limits.landmarks = 33;
  CHECK(first_keyframe(settings, second_view().frame).landmarks.size() == 33);
}

TEST_CASE("new landmarks are looked for where none carried the keyframe's pose", "[track]") {
  const TrackerSettings settings = test::noise_wall_settings();
  WallMap map(test::first_wall_view(), 12, 7);
  const int old = static_cast<int>(map.landmarks.size());
  const WallView& view = second_view();
  PoseSearch seen(settings);
  REQUIRE(seen.find({settings, view.pyramid, map}, view.frame,
                    {.guess = kPose, .previous = kPose, .coarse_first = false}));
  keep(settings, kPose, view, view.frame, seen, map);
  CHECK(map.landmarks.size() > old + 50U);
  const double cell = view.left.width() / 32.0;
  for (std::size_t i = old; i < map.landmarks.size(); ++i) {
    const Eigen::Vector2d uv = map.landmarks[i].uv;
    seen.for_each_inlier([&](const Candidate&, const PosePoint& point) {
      const Eigen::Vector2d taken = point.seen.uvd.head<2>();
      const bool same_cell = std::floor(uv.x() / cell) == std::floor(taken.x() / cell) &&
                             std::floor(uv.y() / cell) == std::floor(taken.y() / cell);
      CHECK_FALSE(same_cell);
    });
  }
  // At most 280 landmarks are searched or new.
  CHECK(map.landmarks.size() - old + static_cast<std::size_t>(seen.inliers()) <= 280);
}

TEST_CASE("a corner at an old landmark's place is that landmark, not a new one", "[track]") {
  const TrackerSettings settings = test::noise_wall_settings();
  LandmarkMap map;
  keep(settings, Rigid3::Identity(), test::first_wall_view(), test::first_wall_view().frame,
       PoseSearch(settings), map);
  const std::vector<Landmark> before = map.landmarks;
  // No landmark is an inlier of the second pose: all are unseen.
  keep(settings, kPose, second_view(), second_view().frame, PoseSearch(settings), map);
  int again = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const Landmark& landmark = map.landmarks[i];
    CHECK(landmark.x_in_world == before[i].x_in_world);
    if (landmark.sightings.size() < 2) continue;
    ++again;
    CHECK(landmark.sightings[1].keyframe == 1);
    CHECK((landmark.sightings[1].seen.uvd -
           kNoiseWallCamera.see(
               kPose * test::wall_at(Rigid3::Identity(), landmark.uv.x(), landmark.uv.y()).second))
              .head<2>()
              .norm() <= tolerance(0.1, "a tenth of a pixel is what patches are good for"));
  }
  CHECK(again > 50);
  // No new landmark is within 2 px of an old one that is alive.
  for (std::size_t i = before.size(); i < map.landmarks.size(); ++i) {
    for (std::size_t k = 0; k < before.size(); ++k) {
      if (!map.landmarks[k].alive) continue;
      const Eigen::Vector2d old = kNoiseWallCamera.camera.project(kPose * before[k].x_in_world);
      const bool same_place = (old - map.landmarks[i].uv).norm() <= 2;
      CHECK_FALSE(same_place);
    }
  }
}

TEST_CASE("an old landmark that looks otherwise where a corner is now is given up, unless smeared",
          "[track]") {
  const TrackerSettings settings = test::noise_wall_settings();
  LandmarkMap map;
  const WallView& view = second_view();
  keep(settings, kPose, view, view.frame, PoseSearch(settings), map);
  const int old = static_cast<int>(map.landmarks.size());
  // Their patches become negatives, which are not found anywhere. The view is the same, so that the
  // corners are at the positions of the old landmarks.
  for (Landmark& landmark : map.landmarks) {
    for (PatchSource::Level& level : landmark.look.levels) {
      for (std::uint8_t& pixel : level.pixels) pixel = static_cast<std::uint8_t>(255 - pixel);
    }
  }
  LandmarkMap smeared = map;

  keep(settings, kPose, view, view.frame, PoseSearch(settings), map);
  CHECK(map.count_alive() == static_cast<int>(map.landmarks.size()) - old);
  CHECK(map.landmarks.size() == 2U * old);

  // The camera moved by 40 px with the shutter open for half of the frame time: landmarks may be
  // missing because of the smear.
  PoseSearch blurred(settings);
  static_cast<void>(blurred.find({settings, view.pyramid, smeared}, view.frame,
                                 {.guess = kPose,
                                  .previous = standing_at(40 / kPxPerMetre, 0, 0) * kPose,
                                  .coarse_first = false,
                                  .exposure = 0.5}));
  REQUIRE(blurred.is_blurred());
  blurred.clear();
  keep(settings, kPose, view, view.frame, blurred, smeared);
  for (int i = 0; i < old; ++i) CHECK(smeared.landmarks[i].alive);
}

}  // namespace
}  // namespace palpable

#include "palpable/live/track/landmark_search.h"

#include "tests/support/noise_wall.h"
#include "tests/support/test.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
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

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
const TrackerSettings kSettings = test::noise_wall_settings();

// A map of one landmark in the middle of the first view.
struct OneLandmark : WallMap {
  OneLandmark() : WallMap(test::first_wall_view(), 1, 1) {}
  [[nodiscard]] std::optional<Candidate> expected(const TrackerFrame& frame,
                                                  const Rigid3& camera_from_world) const {
    const LandmarkSearch search{kSettings, test::first_wall_view().pyramid, *this};
    return search.expected(frame, 0, camera_from_world);
  }
};

TEST_CASE("a landmark is expected where the camera projects it, if it is in view", "[track]") {
  OneLandmark map;
  const TrackerFrame& frame = test::first_wall_view().frame;
  const Rigid3 pose = standing_at(0.1, -0.05, 0.02);
  const std::optional<Candidate> seen = map.expected(frame, pose);
  REQUIRE(seen);
  const Eigen::Vector3d x = pose * map.landmarks[0].x_in_world;
  CHECK(seen->landmark == 0);
  CHECK(seen->uv == kNoiseWallCamera.camera.project(x));
  CHECK(seen->depth == x.z());

  // The landmark is in the middle, 240 px from the left. Shifted by 232 px to the left it is 8 px
  // from the border, where a template does not fit.
  const double middle = map.landmarks[0].uv.x();
  CHECK(map.expected(frame, standing_at((middle - 9) / kPxPerMetre, 0, 0)));
  CHECK_FALSE(map.expected(frame, standing_at((middle - 7) / kPxPerMetre, 0, 0)));
  map.landmarks[0].alive = false;
  CHECK_FALSE(map.expected(frame, pose));
}

TEST_CASE("a landmark is not expected from too far aside, too near, too far off or from behind",
          "[track]") {
  const OneLandmark map;
  // Depths are unknown, so that nothing is hidden.
  const DepthImage unknown(kNoiseWallCamera.camera.width, kNoiseWallCamera.camera.height, kUnknown);
  TrackerFrame frame = test::first_wall_view().frame;
  frame.depth = &unknown;
  const Eigen::Vector3d x = map.landmarks[0].x_in_world;
  const Rigid3 around_landmark(Eigen::Translation3d(x.x(), x.y(), x.z()));
  const auto turned_by = [&](double degrees) {
    return Rigid3(around_landmark *
                  Eigen::AngleAxisd(degrees * std::numbers::pi / 180, Eigen::Vector3d::UnitY()) *
                  around_landmark.inverse());
  };
  CHECK(map.expected(frame, turned_by(52)));  // acos(0.6) = 53.1 degrees
  CHECK_FALSE(map.expected(frame, turned_by(54)));
  const auto zoomed_by = [&](double zoom) {
    return standing_at(x.x() * (1 - 1 / zoom), x.y() * (1 - 1 / zoom), x.z() * (1 - 1 / zoom));
  };
  CHECK(map.expected(frame, zoomed_by(2.25)));
  CHECK_FALSE(map.expected(frame, zoomed_by(2.35)));
  CHECK(map.expected(frame, zoomed_by(1 / 2.25)));
  CHECK_FALSE(map.expected(frame, zoomed_by(1 / 2.35)));
  CHECK_FALSE(map.expected(frame, standing_at(0, 0, 2 * kNoiseWallZ)));
}

TEST_CASE("a landmark is not expected behind a nearer surface or where something moves",
          "[track]") {
  const OneLandmark map;
  TrackerFrame frame = test::first_wall_view().frame;
  const auto expected_behind = [&](double Z) {
    // Depth and mask of half the picture's size.
    const DepthImage depth(kNoiseWallCamera.camera.width / 2, kNoiseWallCamera.camera.height / 2,
                           static_cast<float>(Z));
    frame.depth = &depth;
    return map.expected(frame, Rigid3::Identity()).has_value();
  };
  CHECK(expected_behind(0.91 * kNoiseWallZ));
  CHECK_FALSE(expected_behind(0.89 * kNoiseWallZ));
  CHECK(expected_behind(static_cast<double>(kUnknown)));

  const DepthImage half(kNoiseWallCamera.camera.width / 2, kNoiseWallCamera.camera.height / 2,
                        static_cast<float>(kNoiseWallZ));
  frame.depth = &half;
  MaskImage moving(half.width(), half.height());
  frame.moving = &moving;
  CHECK(map.expected(frame, Rigid3::Identity()));
  // The landmark's pixel lies at (240, 144) of 480 x 288.
  moving(120, 72) = 255;
  CHECK_FALSE(map.expected(frame, Rigid3::Identity()));
  const MaskImage none;
  frame.moving = &none;
  CHECK(map.expected(frame, Rigid3::Identity()));
}

TEST_CASE("of two landmarks in one cell the one that proved is looked for, the best ones first",
          "[track]") {
  const WallView& view = test::first_wall_view();
  TrackerSettings settings = kSettings;
  WallMap map(view, 12, 7);
  // Each landmark of the first row has one beside it, 1 px away, that agreed more often.
  for (int i = 0; i < 12; ++i) {
    map.add(test::wall_landmark(view, map, map.landmarks[i].uv + Eigen::Vector2d(1, 0)),
            map.keyframes[0]);
    map.landmarks.back().inlier = 10 + i;
  }
  map.landmarks[50].last_frame = 98;  // two frames ago
  map.landmarks[60].last_frame = 97;
  std::vector<int> cells;
  std::vector<Candidate> candidates;
  const LandmarkSearch search{settings, view.pyramid, map};
  const auto select = [&] {
    search.select(view.frame, Rigid3::Identity(), standing_at(-0.05, 0, 0), 0.5, 100, cells,
                  candidates);
  };
  select();
  REQUIRE(candidates.size() == 84);
  CHECK(candidates[0].landmark == 50);       // 1/2 and 1/2 for having agreed just now
  CHECK(candidates[1].landmark == 84 + 11);  // 22/23
  CHECK(candidates[12].landmark == 84);      // 11/12
  CHECK(std::none_of(candidates.begin(), candidates.end(),
                     [](const Candidate& candidate) { return candidate.landmark < 12; }));
  for (const Candidate& candidate : candidates) {
    CHECK((candidate.smear - Eigen::Vector2d(-0.5 * 0.05 * kPxPerMetre, 0)).norm() <=
          tolerance(1e-9, "rounding of pixels"));
    CHECK((candidate.warp - Eigen::Matrix2d::Identity()).norm() <=
          tolerance(1e-9, "rounding of pixels"));
  }
  settings.most_landmarks = 13;
  select();
  CHECK(candidates.size() == 13);
  CHECK(candidates.back().landmark == 84);
}

// The candidate of the middle landmark, seen from `pose`, with a prediction that is `off` px too
// far to the right.
Candidate candidate_of(const LandmarkSearch& search, const TrackerFrame& frame, const Rigid3& pose,
                       double off) {
  Candidate candidate = search.expected(frame, 0, pose).value();
  candidate.warp =
      image_from_anchor(kNoiseWallCamera, search.map.landmarks[0], Rigid3::Identity(), pose);
  candidate.uv.x() += off;
  return candidate;
}

TEST_CASE("a landmark is found from small images to large ones, to a tenth of a pixel", "[track]") {
  OneLandmark map;
  // Half as near again, and turned by 20 degrees about the view's axis: the warp matters.
  const Rigid3 pose = Eigen::AngleAxisd(0.35, Eigen::Vector3d::UnitZ()) * standing_at(0, 0, 0.4);
  const WallView view(pose, false);
  const LandmarkSearch search{kSettings, view.pyramid, map};
  const Eigen::Vector2d truth = kNoiseWallCamera.camera.project(pose * map.landmarks[0].x_in_world);
  Eigen::Vector2d uv;
  int level = -1;
  Candidate candidate = candidate_of(search, view.frame, pose, 16);
  REQUIRE(search.find(candidate, 3, 0, 0.7, uv, level));
  CHECK(level == 0);
  CHECK((uv - truth).norm() <= tolerance(0.1, "a tenth of a pixel is what patches are good for"));
  // 16 px are 8 px of level 1, more than PatchSearch::farthest, 6 px.
  CHECK_FALSE(search.find(candidate, 1, 0, 0.7, uv, level));
  candidate.warp.setIdentity();
  CHECK_FALSE(search.find(candidate, 1, 0, 0.7, uv, level));
}

TEST_CASE("where the full picture does not show a landmark, what the halved one shows stands",
          "[track]") {
  OneLandmark map;
  for (std::uint8_t& pixel : map.landmarks[0].look.levels[0].pixels) {
    pixel = static_cast<std::uint8_t>(255 - pixel);
  }
  const Rigid3 pose = standing_at(0.02, 0.01, 0);
  const WallView view(pose, false);
  const LandmarkSearch search{kSettings, view.pyramid, map};
  const Candidate candidate = candidate_of(search, view.frame, pose, 3);
  Eigen::Vector2d uv;
  int level = -1;
  REQUIRE(search.find(candidate, 1, 0, 0.7, uv, level));
  CHECK(level == 1);
  CHECK((uv - kNoiseWallCamera.camera.project(pose * map.landmarks[0].x_in_world)).norm() <=
        tolerance(0.2, "a tenth of a pixel of the halved picture"));
  CHECK_FALSE(search.find(candidate, 0, 0, 0.7, uv, level));
}

TEST_CASE("a disparity is measured in the right picture, or computed from the depth", "[track]") {
  const OneLandmark map;
  const WallView& view = test::first_wall_view();
  TrackerSettings settings = kSettings;
  const LandmarkSearch search{settings, view.pyramid, map};
  const double truth =
      kNoiseWallCamera.camera.fx_px * kNoiseWallCamera.baseline / kNoiseWallZ;  // 13.65 px
  const Eigen::Vector2d uv(200, 100);
  std::optional<double> d = search.disparity_at(view.frame, uv, truth + 1.5);
  REQUIRE(d);
  CHECK(std::abs(*d - truth) <= tolerance(0.1, "a tenth of a pixel is what patches are good for"));
  CHECK_FALSE(search.disparity_at(view.frame, uv, truth + 8));  // found by 3 px at most
  CHECK(search.sigma_of_disparity(view.frame, truth) == LandmarkSearch::kSigmaStereo);
  // The disparity at infinity is subtracted: the same picture gives 2 px less.
  settings.disparity_at_infinity_px = 2;
  d = search.disparity_at(view.frame, uv, truth - 1);
  REQUIRE(d);
  CHECK(std::abs(*d - (truth - 2)) <= tolerance(0.1, "as above"));

  TrackerFrame depth_only = view.frame;
  depth_only.right = nullptr;
  d = search.disparity_at(depth_only, uv, 99);
  REQUIRE(d);
  CHECK(std::abs(*d - truth) <= tolerance(2e-6, "a float's rounding of 1.2 m, in 13.65 px"));
  // Twice the 0.25 px that follow from the settings' noise, and at least 0.2 px.
  CHECK(std::abs(search.sigma_of_disparity(depth_only, truth) - 0.5) <=
        tolerance(1e-12, "rounding"));
  settings.noise = {};
  CHECK(search.sigma_of_disparity(depth_only, truth) == 0.2);
  const DepthImage unknown(view.depth.width(), view.depth.height(), kUnknown);
  depth_only.depth = &unknown;
  CHECK_FALSE(search.disparity_at(depth_only, uv, truth));
}

TEST_CASE("what is found in small or smeared pictures is known less exactly", "[track]") {
  const OneLandmark map;
  const WallView& view = test::first_wall_view();
  const LandmarkSearch search{kSettings, view.pyramid, map};
  Candidate candidate = search.expected(view.frame, 0, Rigid3::Identity()).value();
  const Eigen::Vector2d uv = candidate.uv;
  Sighting seen = search.sighting_of(view.frame, candidate, uv, 0);
  CHECK(seen.uvd.head<2>() == uv);
  CHECK(seen.has_disparity());
  CHECK(seen.sigma == 0.3);
  CHECK(seen.sigma_d == 0.25);
  seen = search.sighting_of(view.frame, candidate, uv, 2);
  CHECK(seen.sigma == 4 * 0.3);
  CHECK(seen.sigma_d == 2 * 0.25);
  candidate.smear = {0, 4};  // 1/4 more per px of the level: twice as much
  CHECK(search.sighting_of(view.frame, candidate, uv, 0).sigma == 2 * 0.3);
  CHECK(search.sighting_of(view.frame, candidate, uv, 1).sigma == 3 * 0.3);
  TrackerFrame depth_only = view.frame;
  depth_only.right = nullptr;
  const DepthImage unknown(view.depth.width(), view.depth.height(), kUnknown);
  depth_only.depth = &unknown;
  CHECK_FALSE(search.sighting_of(depth_only, candidate, uv, 0).has_disparity());
}

}  // namespace
}  // namespace palpable

#include "palpable/live/track/keyframe_work.h"

#include "palpable/live/track/tracker.h"
#include "tests/support/noise_wall.h"
#include "tests/support/test.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

namespace palpable {
namespace {

using test::kNoiseWallCamera;
using test::standing_at;
using test::tolerance;
using test::WallView;

const PinholeCamera kHalf = kNoiseWallCamera.camera.scaled_down(2);

// A walk along the wall with `count` keyframes, 20 mm apart, and exact sightings of a cloud of
// points in front of it.
struct Walk : LandmarkMap {
  explicit Walk(int count) {
    for (int k = 0; k < count; ++k) {
      Keyframe keyframe;
      keyframe.number = 10 * k;
      keyframe.camera_from_world = standing_at(0.02 * k, 0, 0);
      keyframe.thumbnail = {1, 0};
      keyframe.features.uv.emplace_back(static_cast<float>(k), 0.0F);
      keyframes.push_back(keyframe);
    }
    for (int i = 0; i < 60; ++i) {
      Landmark landmark;
      const int column = i % 10, row = i / 10;
      landmark.x_in_world =
          kNoiseWallCamera.camera.unproject(90 + 40 * column, 30 + 40 * row, 0.8 + 0.1 * (i % 7));
      for (int k = 0; k < count; ++k) {
        Sighting seen;
        seen.uvd = kNoiseWallCamera.see(keyframes[k].camera_from_world * landmark.x_in_world);
        landmark.sightings.push_back({k, seen});
        keyframes[k].landmarks.push_back(i);
      }
      landmarks.push_back(landmark);
    }
  }
  // The newest keyframe shares no landmark with the old ones.
  void forget_what_newest_saw() {
    keyframes.back().landmarks.clear();
    for (Landmark& landmark : landmarks) landmark.sightings.pop_back();
  }
};

KeyframeWork work_of(const TrackerSettings& settings, const LandmarkMap& map,
                     std::optional<Loop> closing = {}) {
  const WallView& view = test::first_wall_view();
  return work_for_newest(settings, map, view.pyramid.level(1), view.depth, std::move(closing),
                         std::nullopt);
}

KeyframeWork done_by_worker(const KeyframeWork& work, bool on_thread) {
  KeyframeWorker worker;
  CHECK_FALSE(worker.is_busy());
  worker.begin(work, on_thread);
  CHECK(worker.is_busy());
  KeyframeWork done = worker.finish();
  CHECK_FALSE(worker.is_busy());
  return done;
}

TEST_CASE("a keyframe's work is its features, the window and old keyframes, or a loop instead",
          "[track]") {
  TrackerSettings settings = test::noise_wall_settings();
  Walk walk(kWindow + 4);
  walk.forget_what_newest_saw();
  const KeyframeWork work = work_of(settings, walk);
  CHECK(work.number == 10 * (kWindow + 3));
  CHECK(work.camera == kHalf);
  CHECK(work.image.width() == kHalf.width);
  CHECK(work.window);
  CHECK_FALSE(work.graph);
  // Two of the four that are old enough, each with its number and its features.
  REQUIRE(work.candidates.size() == 2);
  for (const auto& [number, features] : work.candidates) {
    CHECK(number < 40);
    CHECK(10 * features.uv.front().x() == static_cast<float>(number));
  }

  settings.adjust = false;
  CHECK_FALSE(work_of(settings, walk).window);
  CHECK(work_of(settings, walk).candidates.size() == 2);
  settings.close_loops = false;
  CHECK(work_of(settings, walk).candidates.empty());

  settings = test::noise_wall_settings();
  CHECK_FALSE(work_of(settings, Walk(1)).window);  // a single keyframe needs no adjustment
  const Loop loop{0, 10 * (kWindow + 3), {Rigid3::Identity(), 30}};
  const KeyframeWork closing = work_of(settings, walk, loop);
  CHECK((closing.graph && closing.closing));
  CHECK_FALSE(closing.window);
  CHECK(closing.candidates.empty());
  // A loop to a keyframe that was removed: the window is adjusted as usual.
  const KeyframeWork gone = work_of(settings, walk, Loop{5, 10 * (kWindow + 3), {}});
  CHECK_FALSE(gone.graph);
  CHECK(gone.window);
}

TEST_CASE("the window is adjusted to the same bits on a thread and in finish()",
          "[track][threads]") {
  const Walk truth(3);
  Walk walk = truth;
  walk.keyframes[2].camera_from_world = standing_at(0.05, 0.004, 0);
  const KeyframeWork work = work_of(test::noise_wall_settings(), walk);
  const KeyframeWork beside = done_by_worker(work, true), here = done_by_worker(work, false);
  for (const KeyframeWork* done : {&beside, &here}) {
    REQUIRE(done->window);
    const Rigid3 off = done->window->problem.camera_from_world[2] *
                       truth.keyframes[2].camera_from_world.inverse(Eigen::Isometry);
    CHECK((off.matrix() - Rigid3::Identity().matrix()).norm() <=
          tolerance(1e-6, "sightings are exact; the last of ten steps is smaller than this"));
    CHECK(done->features.uv.size() > 100);
    CHECK(done->cpu_s > 0);
  }
  CHECK(beside.cpu_s_of_caller == 0.0);
  CHECK(here.cpu_s_of_caller >= here.cpu_s);
  for (std::size_t k = 0; k < 3; ++k) {
    CHECK(beside.window->problem.camera_from_world[k].matrix() ==
          here.window->problem.camera_from_world[k].matrix());
  }
  CHECK(beside.features.descriptors == here.features.descriptors);
}

TEST_CASE("work that is abandoned leaves the worker free for the next", "[track][threads]") {
  const KeyframeWork work = work_of(test::noise_wall_settings(), Walk(2));
  for (const bool on_thread : {true, false}) {
    KeyframeWorker worker;
    worker.begin(work, on_thread);
    worker.abandon();
    CHECK_FALSE(worker.is_busy());
    KeyframeWork next = work;
    next.number = 77;
    worker.begin(std::move(next), on_thread);
    CHECK(worker.finish().number == 77);
  }
}

// The features of the view from `pose`.
Features features_at(const Rigid3& pose) {
  const WallView view(pose, false);
  return find_features(view.pyramid.level(1), kHalf, view.depth);
}

TEST_CASE("the old keyframe on which most features agree is recognised", "[track]") {
  const Rigid3 now = standing_at(0.1, 0.02, 0.05);
  const WallView view(now, false);
  KeyframeWork work;
  work.number = 90;
  work.image = view.pyramid.level(1);
  work.depth = view.depth;
  work.camera = kHalf;
  // The view from the first pose is nearly the present one, that from the second overlaps by half.
  const Features near = features_at(Rigid3::Identity());
  const Features far = features_at(standing_at(0.7, 0, 0));
  for (const bool near_first : {true, false}) {
    work.candidates = {{3, far}, {8, near}};
    if (near_first) std::swap(work.candidates[0], work.candidates[1]);
    const KeyframeWork done = done_by_worker(work, false);
    REQUIRE(done.loop);
    CHECK(done.loop->old_number == 8);
    CHECK(done.loop->new_number == 90);
    CHECK((done.loop->new_from_old.camera_from_old.matrix() - now.matrix()).norm() <=
          tolerance(0.046,
                    "a feature may be off by 2.5 px, 23 mm at 1.2 m in the half picture; "
                    "twice that"));
  }
  // The second one alone is recognised, too: the first one had more agreeing features.
  work.candidates = {{3, far}};
  REQUIRE(done_by_worker(work, false).loop);
  CHECK(done_by_worker(work, false).loop->old_number == 3);
  // Features that share nothing with the picture, and a set without features.
  work.candidates = {{1, features_at(standing_at(9, 0, 0))}, {2, {}}};
  CHECK_FALSE(done_by_worker(work, false).loop);
}

TEST_CASE("a loop's graph is adjusted, and one that does not hang together is left as it is",
          "[track]") {
  KeyframeWork work;
  work.image = test::first_wall_view().pyramid.level(1);
  work.depth = test::first_wall_view().depth;
  work.camera = kHalf;
  work.graph.emplace();
  work.graph->camera_from_world = {Rigid3::Identity(), standing_at(0.2, 0, 0)};
  KeyframeWork done = done_by_worker(work, false);
  CHECK_FALSE(done.graph_is_solved);
  CHECK(done.graph->camera_from_world[1].matrix() == standing_at(0.2, 0, 0).matrix());

  const Rigid3 truth = standing_at(0.3, 0.1, 0);
  work.graph->ties.push_back({0, 1, truth});
  done = done_by_worker(work, false);
  CHECK(done.graph_is_solved);
  CHECK((done.graph->camera_from_world[1].matrix() - truth.matrix()).norm() <=
        tolerance(1e-9, "one tie can be met exactly"));
}

}  // namespace
}  // namespace palpable

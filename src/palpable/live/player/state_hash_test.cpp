#include "palpable/live/player/state_hash.h"

#include "tests/support/allocations.h"
#include "tests/support/test.h"

#include <functional>
#include <set>
#include <vector>

namespace palpable {
namespace {

Scene some_scene() {
  Scene scene;
  scene.number = 3;
  scene.time = 0.1;
  scene.touches.resize(2);
  scene.bodies.resize(2);
  for (SceneBody& body : scene.bodies) {
    body.vertices.setConstant(3, 4, 0.5F);
    body.normals.setConstant(3, 4, 0.5F);
    body.von_mises.assign(4, 10.0F);
  }
  return scene;
}

TEST_CASE("whatever differs in what was answered, its hash differs", "[player][recording]") {
  const std::vector<std::function<void(Scene&)>> changes{
      [](Scene& s) { s.number = 4; },
      [](Scene& s) { s.time = 0.2; },
      [](Scene& s) { s.mutual_penetration = 1e-9; },
      [](Scene& s) { s.imbalance = 1e-9; },
      [](Scene& s) { s.camera.world_from_camera.translation().x() = 1e-12; },
      [](Scene& s) { s.camera.state = TrackState::kLost; },
      [](Scene& s) { s.camera.landmarks = 1; },
      [](Scene& s) { s.camera.keyframe = true; },
      [](Scene& s) { s.touches.pop_back(); },
      [](Scene& s) { s.touches[1].site = 2; },
      [](Scene& s) { s.touches[1].level = 0.5; },
      [](Scene& s) { s.touches[1].force = 0.5; },
      [](Scene& s) { s.touches[1].press_depth = 0.5; },
      [](Scene& s) { s.touches[1].point_in_body.z() = 0.5; },
      [](Scene& s) { s.touches[1].direction.y() = 0.5; },
      [](Scene& s) { s.touches[1].unseen_for = 0.5; },
      [](Scene& s) { s.touches[1].area = 0.5; },
      [](Scene& s) { s.touches[1].assumed = 0.5; },
      [](Scene& s) { s.touches[1].body = 1; },
      [](Scene& s) { s.touches[1].by = 1; },
      [](Scene& s) { s.touches[0].level = 0.5; },
      [](Scene& s) { s.bodies.pop_back(); },
      [](Scene& s) { s.bodies[1].camera_from_body.translation().z() = 1; },
      [](Scene& s) { s.bodies[1].vertices(2, 3) = 0.5000001F; },
      [](Scene& s) { s.bodies[0].vertices(0, 0) = -0.5F; },
      [](Scene& s) { s.bodies[1].von_mises[3] = 11; },
      [](Scene& s) { s.bodies[1].stated_error = StatedError{}; },
      [](Scene& s) {
        s.bodies[1].stated_error = StatedError{0.1, 0};
      },
      [](Scene& s) {
        s.bodies[1].stated_error = StatedError{0, 0.1};
      }};
  std::set<std::uint64_t> hashes{state_hash(some_scene())};
  for (const auto& change : changes) {
    Scene scene = some_scene();
    change(scene);
    hashes.insert(state_hash(scene));
  }
  CHECK(hashes.size() == changes.size() + 1);
}

TEST_CASE(
    "how long it took, and what is kept to be painted, is no part of a state, and hashing takes no "
    "memory",
    "[player][recording]") {
  Scene scene = some_scene();
  const std::uint64_t before = state_hash(scene);
  scene.times.add("contact", 3);
  scene.bodies[1].cauchy.assign(24, 10.0F);  // used for drawing only
  CHECK(state_hash(scene) == before);
  std::uint64_t hash = 0;
  CHECK(test::allocations_during([&] { hash = state_hash(scene); }) == 0);
  CHECK(hash == before);
}

TEST_CASE("a comparison names the first frame that differs, and other frames differ",
          "[player][recording]") {
  StateComparison comparison({{0, 10, ""}, {1, 11, ""}, {3, 13, ""}, {4, 14, ""}});
  comparison.add(0, 10);
  CHECK_FALSE(comparison.first_different());
  comparison.add(1, 12);
  comparison.add(2, 13);  // the live run has frame 3 here
  comparison.add(4, 14);
  comparison.add(5, 15);  // after the end of the live run
  CHECK(comparison.compared() == 4);
  CHECK(comparison.expected() == 4);
  CHECK(comparison.different() == 2);
  CHECK(comparison.first_different() == 1);
}

TEST_CASE("the hash of a run depends on the order of its states", "[player][recording]") {
  const auto of = [](std::vector<std::uint64_t> states) {
    RunHash hash;
    for (const std::uint64_t state : states) hash.add(state);
    CHECK(hash.count() == static_cast<int>(states.size()));
    CHECK(hash.text().size() == 16);
    return hash.text();
  };
  CHECK(of({1, 2}) == of({1, 2}));
  CHECK(of({1, 2}) != of({2, 1}));
  CHECK(of({1}) != of({1, 0}));
}

}  // namespace
}  // namespace palpable

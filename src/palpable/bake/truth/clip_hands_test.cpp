#include "palpable/bake/truth/clip_hands.h"

#include "palpable/common/base/error.h"
#include "palpable/common/base/output_file.h"
#include "palpable/desk/clip_files/camera_paths.h"
#include "palpable/desk/clip_files/frame_records.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <numbers>

namespace palpable {
namespace {

using Catch::Matchers::Contains;
using Eigen::Vector3d;
using test::tolerance;

std::vector<ContactLine> touching_in(const std::vector<int>& frames, int count) {
  std::vector<ContactLine> contacts;
  for (int n = 0; n < count; ++n) {
    const bool touches = std::find(frames.begin(), frames.end(), n) != frames.end();
    contacts.push_back({.frame = n, .touching = touches, .depth = touches ? 1e-3 * n : 0.0});
  }
  return contacts;
}

TEST_CASE("wanted frames are spread over the touching ones and belong to their touch", "[truth]") {
  const auto contacts = touching_in({3, 4, 5, 6, 10, 11, 12, 13}, 16);
  const std::vector<Episode> all = episodes_of(contacts, 100, 1.0);
  REQUIRE(all.size() == 2);
  CHECK(all[0].first == 3);
  CHECK(all[0].wanted == std::vector{3, 4, 5, 6});
  CHECK(all[1].first == 10);
  CHECK(all[1].wanted == std::vector{10, 11, 12, 13});

  const std::vector<Episode> four = episodes_of(contacts, 4, 1.0);
  CHECK(four[0].wanted == std::vector{4, 6});
  CHECK(four[1].wanted == std::vector{11, 13});

  // Too deep ones are not wanted, but the touch still begins where it begins.
  const std::vector<Episode> shallow = episodes_of(contacts, 100, 11.5e-3);
  CHECK(shallow[1].first == 10);
  CHECK(shallow[1].wanted == std::vector{10, 11});
  CHECK(episodes_of(touching_in({}, 5), 24, 1.0).empty());
}

// The camera moves along X. The body stands upright, 0.4 m in front of its first position.
void write_clip(const std::filesystem::path& clip) {
  make_folder(clip / "frames");
  make_folder(clip / "truth");
  write_whole_file(clip / "frames" / "scene.toml",
                   "camera_from_body = [1,0,0,0, 0,0,-1,0, 0,1,0,0.4, 0,0,0,1]\n");
  std::string hands, contacts, poses;
  for (int n = 0; n < 3; ++n) {
    StampedPose pose;
    pose.time = n / 30.0;
    pose.world_from_camera.translation().x() = 0.1 * n;
    poses += trajectory_line(pose);
    // At rest in the world, so that it moves the other way in the camera's frame.
    hands += hand_line({n, {{{-0.1 * n, -0.05, 0.4}, {-0.1 * n, -0.15, 0.4}, 0.01, 0.02}}});
    contacts += contact_line({.frame = n});
  }
  write_whole_file(clip / "truth" / "hand.jsonl", hands);
  write_whole_file(clip / "truth" / "contact.jsonl", contacts);
  write_whole_file(clip / "truth" / "trajectory.txt", poses);
}

TEST_CASE("a hand that stands still in the world stands still before the body", "[truth]") {
  const test::ScratchFolder folder("clip_hands");
  write_clip(folder.path());
  const ClipHands hands = read_clip_hands(folder.path());
  REQUIRE(hands.frame_count() == 3);
  for (const std::vector<Capsule>& capsules : hands.capsules) {
    REQUIRE(capsules.size() == 1);
    CHECK((capsules[0].a - Vector3d(0, 0, 0.05)).norm() <= tolerance(1e-6, "six decimals"));
    CHECK((capsules[0].b - Vector3d(0, 0, 0.15)).norm() <= tolerance(1e-6, "six decimals"));
  }
  write_whole_file(folder.path() / "truth" / "hand.jsonl", hand_line({0, {}}));
  CHECK_THROWS_WITH(read_clip_hands(folder.path()),
                    Contains("hand.jsonl: has 1 frames and contact.jsonl 3"));
  write_whole_file(folder.path() / "frames" / "scene.toml", "fps = 30\n");
  CHECK_THROWS_WITH(read_clip_hands(folder.path()), Contains("scene.toml"));
}

TEST_CASE("between two frames a capsule's ends go straight", "[truth]") {
  ClipHands hands;
  hands.contacts.resize(3);
  hands.capsules = {{{{0, 0, 0}, {0, 0, 1}, 0.1, 0.2}}, {{{1, 0, 0}, {1, 0, 2}, 0.3, 0.2}}, {}};
  const std::vector<Capsule> quarter = capsules_at(hands, 0.25);
  REQUIRE(quarter.size() == 1);
  CHECK((quarter[0].a - Vector3d(0.25, 0, 0)).norm() < 1e-15);
  CHECK((quarter[0].b - Vector3d(0.25, 0, 1.25)).norm() < 1e-15);
  CHECK(quarter[0].ra == Approx(0.15));
  CHECK(capsules_at(hands, -1.0).size() == 1);
  // Between frames with different numbers of capsules, those of the nearer frame are returned.
  CHECK(capsules_at(hands, 1.4).size() == 1);
  CHECK(capsules_at(hands, 1.6).empty());
  CHECK(capsules_at(hands, 9.0).empty());
}

}  // namespace
}  // namespace palpable

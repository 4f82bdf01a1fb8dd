#include "palpable/desk/clip_files/clip_hands.h"

#include "palpable/common/base/output_file.h"
#include "palpable/desk/clip_files/camera_paths.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

namespace palpable {
namespace {

using Catch::Matchers::Contains;
using Eigen::Vector3d;
using test::tolerance;

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

TEST_CASE("a hand that stands still in the world stands still before the body", "[clip_files]") {
  const test::ScratchFolder folder("clip_hands");
  write_clip(folder.path());
  const ClipHands hands = read_clip_hands(folder.path());
  REQUIRE(hands.frame_count() == 3);
  CHECK(hands.times[2] == Approx(2 / 30.0).margin(1e-6));
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

}  // namespace
}  // namespace palpable

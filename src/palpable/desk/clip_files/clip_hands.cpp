#include "palpable/desk/clip_files/clip_hands.h"

#include "palpable/common/base/error.h"
#include "palpable/desk/clip_files/camera_paths.h"
#include "palpable/desk/clip_files/scene_files.h"

#include <fmt/core.h>

#include <utility>

namespace palpable {

namespace fs = std::filesystem;

ClipHands read_clip_hands(const fs::path& clip, const std::string& body) {
  const fs::path truth = clip / "truth";
  const fs::path part = body.empty() ? truth : truth / "bodies" / body;
  const fs::path scene_file = (body.empty() ? clip / "frames" : part) / "scene.toml";
  ClipHands hands;
  hands.contacts = read_contacts(part / "contact.jsonl");
  const std::vector<HandLine> lines = read_hands(truth / "hand.jsonl");
  const std::vector<StampedPose> poses = read_trajectory(truth / "trajectory.txt");
  const SceneFile scene = read_scene_file(scene_file);
  if (!scene.camera_from_body) {
    throw Error(fmt::format("{}: does not say where the body stands (camera_from_body)",
                            scene_file.string()));
  }
  const auto count = hands.contacts.size();
  const auto check = [&](const char* file, std::size_t found) {
    if (found == count) return;
    throw Error(fmt::format("{}: has {} frames and contact.jsonl {}", (truth / file).string(),
                            found, count));
  };
  check("hand.jsonl", lines.size());
  check("trajectory.txt", poses.size());
  // The world is the camera of the first frame.
  const Rigid3 body_from_world = scene.camera_from_body->inverse();
  for (std::size_t n = 0; n < count; ++n) {
    if (hands.contacts[n].frame != static_cast<int>(n) || lines[n].frame != static_cast<int>(n)) {
      throw Error(fmt::format("{}: frame {} is missing", truth.string(), n));
    }
    const Rigid3 body_from_camera = body_from_world * poses[n].world_from_camera;
    for (const Capsule& capsule : lines[n].capsules) {
      if (capsule.ra > 0.0 && capsule.rb > 0.0) continue;
      throw Error(fmt::format("{}: frame {} has a capsule without a radius",
                              (truth / "hand.jsonl").string(), n));
    }
    hands.capsules.push_back(transformed(lines[n].capsules, body_from_camera));
    hands.body_from_camera.push_back(body_from_camera);
    hands.times.push_back(poses[n].time);
  }
  return hands;
}

}  // namespace palpable

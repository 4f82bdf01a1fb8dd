#include "palpable/bake/truth/clip_hands.h"

#include "palpable/common/base/error.h"
#include "palpable/desk/clip_files/camera_paths.h"
#include "palpable/desk/clip_files/frame_records.h"
#include "palpable/desk/clip_files/scene_files.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

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
    std::vector<Capsule> capsules = lines[n].capsules;
    for (const Capsule& capsule : capsules) {
      if (capsule.ra > 0.0 && capsule.rb > 0.0) continue;
      throw Error(fmt::format("{}: frame {} has a capsule without a radius",
                              (truth / "hand.jsonl").string(), n));
    }
    for (Capsule& capsule : capsules) {
      capsule.a = body_from_camera * capsule.a;
      capsule.b = body_from_camera * capsule.b;
    }
    hands.capsules.push_back(std::move(capsules));
    hands.body_from_camera.push_back(body_from_camera);
  }
  return hands;
}

std::vector<Episode> episodes_of(const std::vector<ContactLine>& contacts, int count,
                                 double deepest) {
  std::vector<int> touching;
  for (const ContactLine& contact : contacts) {
    if (contact.touching && contact.depth <= deepest) touching.push_back(contact.frame);
  }
  const int there = static_cast<int>(touching.size());
  const int chosen = std::min(count, there);
  std::vector<Episode> episodes;
  for (int i = 0; i < chosen; ++i) {
    const int frame = touching[static_cast<std::size_t>((i + 0.5) * there / chosen)];
    int first = frame;
    while (first > 0 && contacts[first - 1].touching) --first;
    if (episodes.empty() || episodes.back().first != first) episodes.push_back({first, {}});
    episodes.back().wanted.push_back(frame);
  }
  return episodes;
}

std::vector<Capsule> capsules_at(const ClipHands& hands, double t) {
  const double last = hands.frame_count() - 1.0;
  const double within = std::clamp(t, 0.0, last);
  const auto before = static_cast<std::size_t>(within);
  const double share = within - static_cast<double>(before);
  if (share == 0.0) return hands.capsules[before];
  const std::vector<Capsule>& from = hands.capsules[before];
  const std::vector<Capsule>& to = hands.capsules[before + 1];
  if (from.size() != to.size()) return share < 0.5 ? from : to;
  std::vector<Capsule> between;
  for (std::size_t k = 0; k < from.size(); ++k) {
    const auto mix = [&](const auto& a, const auto& b) { return (1.0 - share) * a + share * b; };
    between.push_back({mix(from[k].a, to[k].a), mix(from[k].b, to[k].b), mix(from[k].ra, to[k].ra),
                       mix(from[k].rb, to[k].rb)});
  }
  return between;
}

}  // namespace palpable

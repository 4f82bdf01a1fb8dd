#include "palpable/live/player/state_hash.h"

#include <fmt/core.h>

namespace palpable {
namespace {

void add(WordHash& hash, const Rigid3& transform) {
  hash.add(transform.data(), sizeof(double) * static_cast<std::size_t>(transform.matrix().size()));
}

void add(WordHash& hash, const Eigen::Vector3d& v) { hash.add(v.data(), 3 * sizeof(double)); }

void add(WordHash& hash, const Touch& touch) {
  hash.add(touch.site);
  hash.add(touch.body);
  hash.add(touch.by);
  for (const double x :
       {touch.level, touch.force, touch.press_depth, touch.unseen_for, touch.area, touch.assumed}) {
    hash.add(x);
  }
  add(hash, touch.point_in_body);
  add(hash, touch.direction);
  // Hashes of states without friction are those of earlier versions.
  if (!touch.friction.isZero(0)) add(hash, touch.friction);
}

void add(WordHash& hash, const TrackedPose& camera) {
  add(hash, camera.world_from_camera);
  hash.add(static_cast<int>(camera.state));
  hash.add(camera.landmarks);
  hash.add(camera.tried);
  hash.add(camera.newest_keyframe);
  hash.add(camera.keyframe + 2 * camera.closed_loop + 4 * camera.new_world);
}

void add(WordHash& hash, const SceneBody& body) {
  add(hash, body.camera_from_body);
  hash.add(body.vertices.data(), sizeof(float) * static_cast<std::size_t>(body.vertices.size()));
  hash.add(body.von_mises.data(), sizeof(float) * body.von_mises.size());
  hash.add(static_cast<int>(body.stated_error.has_value()));
  const StatedError error = body.stated_error.value_or(StatedError{});
  hash.add(error.displacement);
  hash.add(error.von_mises);
}

}  // namespace

std::uint64_t state_hash(const Scene& scene) {
  WordHash hash;
  hash.add(scene.number);
  hash.add(scene.time);
  add(hash, scene.camera);
  hash.add(scene.mutual_penetration);
  hash.add(scene.imbalance);
  hash.add(scene.touches.size());
  for (const Touch& touch : scene.touches) add(hash, touch);
  hash.add(scene.bodies.size());
  for (const SceneBody& body : scene.bodies) add(hash, body);
  return hash.value();
}

std::string RunHash::text() const { return fmt::format("{:016x}", hash_.value()); }

void StateComparison::add(int number, std::uint64_t hash) {
  if (compared_ == expected()) return;
  const RecordedState& was = expected_[static_cast<std::size_t>(compared_++)];
  if (was.number == number && was.hash == hash) return;
  ++different_;
  if (!first_different_) first_different_ = number;
}

}  // namespace palpable

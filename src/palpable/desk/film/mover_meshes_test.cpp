#include "palpable/desk/film/mover_meshes.h"

#include "tests/support/test.h"

#include <algorithm>
#include <array>

using namespace palpable;

namespace {

std::vector<HandCapsule> hand(const HandGesture& gesture, const Eigen::Vector3d& wrist) {
  HandPose pose;
  pose.gesture = gesture;
  pose.desk_from_wrist =
      Eigen::Translation3d(wrist) * Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 0.5).normalized());
  pose.elbow = wrist + Eigen::Vector3d(-0.25, 0.0, 0.0);
  pose.shoulder = wrist + Eigen::Vector3d(-0.50, 0.0, 0.1);
  return hand_capsules(pose);
}

std::size_t triangle_count(const std::vector<PaintedMesh>& meshes) {
  std::size_t count = 0;
  for (const PaintedMesh& mesh : meshes) count += mesh.indices.size() / 3;
  return count;
}

/// Number of triangles whose corners all lie deeper than `depth` (m) inside one capsule.
int hidden(const std::vector<PaintedMesh>& meshes, const std::vector<HandCapsule>& capsules,
           double depth) {
  int count = 0;
  for (const PaintedMesh& mesh : meshes)
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3)
      count += std::any_of(capsules.begin(), capsules.end(), [&](const HandCapsule& capsule) {
        return std::all_of(&mesh.indices[i], &mesh.indices[i] + 3, [&](std::uint32_t v) {
          return signed_distance(capsule.shape, mesh.vertices[v].position.cast<double>()) < -depth;
        });
      });
  return count;
}

}  // namespace

// The test of the true depth (desk_renderer_test.cpp) shows that no visible triangle is missing.
TEST_CASE("triangles inside a hand are left out, for two instants those inside at both", "[film]") {
  const std::vector<HandCapsule> open = hand(open_gesture(), {0.0, 0.0, 0.2});
  const std::vector<HandCapsule> closed = hand(pointing_gesture(), {0.01, 0.02, 0.2});
  std::size_t all = 0;
  for (const HandCapsule& capsule : open)
    all += triangle_count(mover_meshes(std::array{capsule}, std::nullopt, {}));

  const auto alone = mover_meshes(open, std::nullopt, {});
  CHECK(hidden(alone, open, 0.0002) == 0);
  CHECK(triangle_count(alone) < 7 * all / 10);

  const auto first = mover_meshes(open, std::nullopt, {}, closed);
  const auto last = mover_meshes(closed, std::nullopt, {}, open);
  REQUIRE(first.size() == last.size());
  for (std::size_t i = 0; i < first.size(); ++i) CHECK(first[i].indices == last[i].indices);
  CHECK(triangle_count(first) > triangle_count(alone));
  CHECK(triangle_count(first) < all);
}

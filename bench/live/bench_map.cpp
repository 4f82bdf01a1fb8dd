#include "bench/live/bench_map.h"

#include "apps/common/progress_bar.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/desk/clip_writer/desk_film.h"
#include "palpable/live/depth/depth_camera.h"
#include "palpable/live/slam/slam.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace palpable::app {
namespace {

constexpr int kLookEvery = 3;  // interval of frames whose hand is searched for ghosts
constexpr int kBeside = 3;     // px, tolerance for the edge of a true surface
// A ghost is nearer than all true surfaces by more than max(kLeastError, kSigmas * sigma_Z).
constexpr double kLeastError = 0.04;  // m
constexpr double kSigmas = 4;

// The nearest true depth within kBeside of a point's pixel, m; infinite where nothing is there, NaN
// outside the picture.
double nearest_truth(const DepthImage& truth, const PinholeCamera& view,
                     const Eigen::Vector3d& point) {
  if (!(point.z() > 0)) return std::nan("");
  const Eigen::Vector2d at = view.project(point);
  // Compared before rounding, because the pixel of a point beside the camera may exceed an int.
  if (!(at.x() > -0.5 && at.y() > -0.5 && at.x() < view.width - 0.5 &&
        at.y() < view.height - 0.5)) {
    return std::nan("");
  }
  const int u = static_cast<int>(std::lround(at.x())), v = static_cast<int>(std::lround(at.y()));
  double nearest = std::numeric_limits<double>::infinity();
  for (int y = std::max(v - kBeside, 0); y <= std::min(v + kBeside, view.height - 1); ++y) {
    for (int x = std::max(u - kBeside, 0); x <= std::min(u + kBeside, view.width - 1); ++x) {
      const auto Z = static_cast<double>(truth(x, y));
      if (Z < nearest) nearest = Z;  // false for NaN
    }
  }
  return nearest;
}

// Counts the vertices of the map's surface that are at the hand's position of any frame before
// `last`, where in truth nothing is.
int ghosts(const SurfaceMap& map, const Sequence& sequence, int last, const DepthCamera& camera,
           DeskRenderer& renderer) {
  Sequence alone = sequence;
  alone.movers = [](double) { return Movers{}; };
  const Eigen::Matrix3Xd in_desk =
      sequence.camera_from_desk(0.0).inverse() * map.mesh().surface.vertices;
  const double reach = 2 * map.settings().voxel;
  std::vector<bool> ghost(in_desk.cols(), false);
  DeskTruth truth;
  for (int frame = kFramesWithoutHand; frame < last; frame += kLookEvery) {
    const std::vector<Capsule> hand = shapes_of(sequence.movers(frame).capsules);
    if (hand.empty()) continue;
    Eigen::AlignedBox3d box;
    for (const Capsule& part : hand) {
      const Eigen::Vector3d round = Eigen::Vector3d::Constant(std::max(part.ra, part.rb) + reach);
      for (const Eigen::Vector3d& end : {part.a, part.b}) {
        box.extend(Eigen::Vector3d(end - round));
        box.extend(Eigen::Vector3d(end + round));
      }
    }
    renderer.draw_truth(moment_of(alone, frame), camera.depth_camera(),
                        camera.rectified()->baseline, truth);
    const Rigid3 camera_from_desk = sequence.camera_from_desk(frame);
    for (Eigen::Index i = 0; i < in_desk.cols(); ++i) {
      const Eigen::Vector3d point = in_desk.col(i);
      if (!box.contains(point) || signed_distance(hand, point) > reach) continue;
      const Eigen::Vector3d seen = camera_from_desk * point;
      const double Z = nearest_truth(truth.depth, camera.depth_camera(), seen);
      const double error = std::max(kLeastError, kSigmas * camera.noise().sigma(seen.z()));
      if (seen.z() < Z - error) ghost[i] = true;
    }
  }
  return static_cast<int>(std::count(ghost.begin(), ghost.end(), true));
}

}  // namespace

void bench_map(const ReducedBody& body, std::uint64_t seed, int frames, ProgressBar& bar,
               Json& result) {
  PALPABLE_EXPECT(frames >= kFewestHandFrames, "the hand comes and goes");
  Sequence sequence = plan_sequence("walk-hand", desk_body(body), frames, seed);
  const int gone = frames - kFramesAfterHand;
  sequence.movers = [planned = sequence.movers, gone](double frame) {
    return frame < gone ? planned(frame) : Movers{};
  };
  Film film = film_of(sequence);
  const FrameFormat format = format_of(film.rig);
  DepthCamera camera = value_or_throw(DepthCamera::make(format));
  Slam slam(camera);
  SurfaceMap of_all(camera.noise());

  RawPair pair;
  Frame frame;
  SeenFrame seen;
  StageTimes times;
  SlamCounts before;  // before the hand appears
  for (int n = 0; n < frames; ++n) {
    if (n == gone) {
      result["ghost_voxels_no_mask"] = ghosts(of_all, sequence, gone, camera, film.renderer);
    }
    film.renderer.draw(moment_of(sequence, n), pair);
    frame.number = n;
    frame.time = n / kFramesPerSecond;
    frame.left = pair.left;
    frame.right = pair.right;
    camera.see(frame, seen);
    if (n == kFramesWithoutHand) before = slam.counts();
    const SlamFrame& found = slam.advance(seen, times);
    if (found.fused && n < gone) {
      of_all.fuse(seen.depth, seen.depth_camera, found.camera.world_from_camera);
    }
    bar.show({"mapping", n + 1.0, static_cast<double>(frames), ""});
  }
  const SlamCounts& after = slam.counts();
  const int masks = after.masks - before.masks, fused = after.fused - before.fused;
  if (masks == 0 || fused == 0) {
    throw Error("walk-hand: the camera was lost from the first hand on");
  }
  result["mask_ms"] = 1e3 * (after.mask_cpu_s - before.mask_cpu_s) / masks;
  result["map_ms"] = 1e3 * (after.fuse_cpu_s - before.fuse_cpu_s) / fused;
  result["ghost_voxels"] = ghosts(*slam.map(), sequence, gone, camera, film.renderer);
}

}  // namespace palpable::app

#include "palpable/bake/truth/frame_steps.h"

#include "palpable/common/geometry/capsule.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace palpable {

using Eigen::Matrix3Xd;

namespace {

double longest_edge(const SurfaceMesh& surface) {
  double longest = 0.0;
  for (int t = 0; t < surface.triangle_count(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int a = surface.triangles(k, t), b = surface.triangles((k + 1) % 3, t);
      longest = std::max(longest, (surface.vertices.col(a) - surface.vertices.col(b)).norm());
    }
  }
  return longest;
}

}  // namespace

FrameSteps::FrameSteps(const ClipHands& hands, const TetMesh& mesh)
    : hands_(&hands),
      mesh_(&mesh),
      boundary_(boundary_of(mesh)),
      edge_(longest_edge(boundary_.surface)) {}

int FrameSteps::count(int frame, const Matrix3Xd& displacement, double longest, int shorter) const {
  const double way = way_in_frame(frame, displacement);
  if (way == 0.0) return 1;
  return shorter * static_cast<int>(std::ceil(way / longest));
}

// m, the largest movement of a capsule's end from the frame before, of the capsules that may touch
// the body on the way. Such a capsule ends no farther from some vertex of the skin than it moves
// plus the longest edge, for no point of a triangle is farther from a corner than that edge.
double FrameSteps::way_in_frame(int frame, const Matrix3Xd& displacement) const {
  if (frame == 0) return 0.0;
  const Matrix3Xd skin = (mesh_->nodes + displacement)(Eigen::all, boundary_.node_of_vertex);
  const Eigen::AlignedBox3d box(skin.rowwise().minCoeff(), skin.rowwise().maxCoeff());
  const std::vector<Capsule>& capsules = hands_->capsules[static_cast<std::size_t>(frame)];
  double way = 0.0;
  for (std::size_t k = 0; k < capsules.size(); ++k) {
    const double moved = movement(frame, k), reach = moved + edge_;
    if (moved <= way || box_of(capsules[k]).squaredExteriorDistance(box) > reach * reach) continue;
    const CapsuleField capsule(capsules[k]);
    const auto is_near = [&](const auto& x) { return capsule.distance(x) < reach; };
    const auto vertices = skin.colwise();
    if (std::any_of(vertices.begin(), vertices.end(), is_near)) way = moved;
  }
  return way;
}

// m, the larger movement of a capsule's two ends from the frame before. Where a capsule has come or
// gone, the others have new numbers: the one there that is nearest is taken for the same.
double FrameSteps::movement(int frame, std::size_t capsule) const {
  const auto now = static_cast<std::size_t>(frame);
  const std::vector<Capsule>&from = hands_->capsules[now - 1], &to = hands_->capsules[now];
  const auto moved_from = [&](const Capsule& before) {
    return std::max((to[capsule].a - before.a).norm(), (to[capsule].b - before.b).norm());
  };
  if (from.size() == to.size()) return moved_from(from[capsule]);
  if (from.empty()) return 0.0;
  double least = std::numeric_limits<double>::infinity();
  for (const Capsule& before : from) least = std::min(least, moved_from(before));
  return least;
}

}  // namespace palpable

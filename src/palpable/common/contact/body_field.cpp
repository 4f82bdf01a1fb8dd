#include "palpable/common/contact/body_field.h"

#include <algorithm>

namespace palpable {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr float kCell = 0.008f;    // m, side of a grid cell; larger if kMostNodes would be exceeded
constexpr float kMostNodes = 64;   // cells along one side of the grid, at most
constexpr float kMargin = 0.024f;  // m around the body; smaller balls outside it cannot overlap
constexpr float kToNode = 0.87f;   // largest distance from the nearest node, ratio to kCell

}  // namespace

BodyField::BodyField(const ReducedBody& body) : distance_(body.surface), fixed_(body.fixed) {
  const Eigen::Matrix3Xd& x = body.surface.vertices;
  low_ = x.rowwise().minCoeff().cast<float>() - Vector3f::Constant(kMargin);
  const Vector3f high = x.rowwise().maxCoeff().cast<float>() + Vector3f::Constant(kMargin);
  cell_ = std::max(kCell, (high - low_).maxCoeff() / kMostNodes);
  nodes_ = ((high - low_) / cell_).array().ceil().cast<int>() + 1;
  at_node_.reserve(static_cast<std::size_t>(nodes_.prod()));
  for (int k = 0; k < nodes_.z(); ++k) {
    for (int j = 0; j < nodes_.y(); ++j) {
      for (int i = 0; i < nodes_.x(); ++i) {
        const Vector3f node = low_ + cell_ * Eigen::Vector3i(i, j, k).cast<float>();
        at_node_.push_back(static_cast<float>(distance_.nearest(node.cast<double>()).distance));
      }
    }
  }
}

std::optional<BodyField::Overlap> BodyField::overlap(const Vector3f& centre, float radius) const {
  const Eigen::Vector3i node = ((centre - low_) / cell_).array().round().cast<int>();
  const bool in_grid = (node.array() >= 0).all() && (node.array() < nodes_.array()).all();
  if (!in_grid && radius < kMargin) return std::nullopt;
  if (in_grid) {
    const float there = at_node_[static_cast<std::size_t>(
        (node.z() * nodes_.y() + node.y()) * nodes_.x() + node.x())];
    if (there - kToNode * cell_ > radius) return std::nullopt;
  }
  const NearestOnSurface found = distance_.nearest(centre.cast<double>());
  const double depth = static_cast<double>(radius) - found.distance;
  if (depth <= 0) return std::nullopt;
  const Eigen::Vector3i corner = distance_.surface().triangles.col(found.triangle);
  for (int k = 0; k < 3; ++k) {
    if (found.weights[k] > 1e-6 && fixed_[corner[k]] == 0) {
      return Overlap{depth, found.point.cast<float>()};
    }
  }
  return std::nullopt;
}

}  // namespace palpable

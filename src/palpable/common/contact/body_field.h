/// @file
/// How deep a ball is inside the body at rest.
#pragma once

#include "palpable/common/geometry/surface_distance.h"
#include "palpable/common/reduced/reduced_body.h"

#include <Eigen/Core>

#include <cstdint>
#include <optional>
#include <vector>

namespace palpable {

/// The signed distance of the skin of a body at rest, for queries by balls. Body frame, m.
class BodyField {
 public:
  /// A ball that overlaps the body.
  struct Overlap {
    double depth = 0;       ///< m > 0: how far the ball reaches beyond the skin, along its normal
    Eigen::Vector3f place;  ///< m, position on the skin nearest to the ball's centre
  };

  explicit BodyField(const ReducedBody& body);

  /// Nothing if the ball does not reach the skin, or reaches it only where the support holds it.
  /// O(log V) for balls near the body; others cost one look into a table.
  [[nodiscard]] std::optional<Overlap> overlap(const Eigen::Vector3f& centre, float radius) const;

 private:
  SurfaceDistance distance_;
  std::vector<std::uint8_t> fixed_;
  // Signed distances at the nodes of a coarse grid. The distance of a point from the skin differs
  // from that of its nearest node by at most the distance between them.
  float cell_ = 0;  // m
  Eigen::Vector3f low_;
  Eigen::Vector3i nodes_;
  std::vector<float> at_node_;
};

}  // namespace palpable

/// @file
/// How deep balls are inside the body at rest.
#pragma once

#include "palpable/common/geometry/surface_distance.h"
#include "palpable/common/reduced/reduced_body.h"

#include <Eigen/Core>

#include <cstdint>
#include <optional>
#include <vector>

namespace palpable {

/// The skin of a body at rest, asked by balls. Body frame, m.
class BodyField {
 public:
  /// A ball that overlaps the body.
  struct Overlap {
    double depth = 0;       ///< m > 0: how far the ball reaches beyond the skin, along its normal
    Eigen::Vector3f place;  ///< m, of the skin, nearest to the ball's middle
  };

  explicit BodyField(const ReducedBody& body);

  /// Nothing where the ball does not reach the skin, and where the support holds the skin: it does
  /// not give way there. O(log V) for balls near the body, else a look into a table.
  [[nodiscard]] std::optional<Overlap> overlap(const Eigen::Vector3f& centre, float radius) const;

 private:
  SurfaceDistance distance_;
  std::vector<std::uint8_t> fixed_;
  // Distances at the nodes of a coarse grid: within a cell they differ by at most the way there.
  float cell_ = 0;  // m
  Eigen::Vector3f low_;
  Eigen::Vector3i nodes_;
  std::vector<float> at_node_;
};

}  // namespace palpable

/// @file
/// The compliance among the few vertices that touch, ready to be multiplied. A finger that slides
/// brings some new vertices in each frame and keeps most: only what is new is computed.
#pragma once

#include "palpable/common/response/compliance.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace palpable {

/// Values do not depend on what was asked before, only the time does. Allocates in its constructor.
class ComplianceCache {
 public:
  /// @param compliance  outlives this
  /// @param most        vertices that are wanted at a time
  ComplianceCache(const Compliance& compliance, int most);

  /// Makes the blocks among all of these vertices available.
  /// @pre no vertex twice, and at most as many as the constructor was told
  void bring(std::span<const int> vertices);

  /// Where a vertex that was brought has its rows.
  [[nodiscard]] int slot_of(int vertex) const { return slot_of_vertex_[vertex]; }
  /// Displacement of the vertex in slot i by a force at that in slot j, m/N.
  [[nodiscard]] Eigen::Matrix3f block(int i, int j) const {
    return blocks_.block<3, 3>(3 * i, 3 * j);
  }
  /// All of them: row and column 3 i + d belong to component d at slot i. What slots that were not
  /// brought have means nothing.
  [[nodiscard]] const Eigen::MatrixXf& blocks() const { return blocks_; }

 private:
  void compute(int slot);
  [[nodiscard]] Eigen::Matrix3f block_of(int vertex, int other);
  [[nodiscard]] std::span<const float> targets_at(int slot, int from, int to);

  const Compliance& compliance_;
  int most_;
  std::vector<int> slot_of_vertex_;  // (V) -1: none
  std::vector<int> vertex_of_slot_;  // (most) -1: free
  std::vector<char> wanted_;         // (most)
  std::vector<float> basis_;         // (3 most x k) rows of P
  Eigen::MatrixXf blocks_;           // (3 most x 3 most)
  std::vector<char> has_target_;     // (most x C)
  std::vector<float> targets_;       // (most x C x 3 x k) of unit forces in x, y, z
};

}  // namespace palpable

/// @file
/// The compliance among the few vertices that take part in contact, as one matrix. A finger that
/// slides brings a few new vertices in each frame: only their blocks are computed.
#pragma once

#include "palpable/common/response/compliance.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace palpable {

/// The values do not depend on earlier calls, only the time of a call does. Allocates in its
/// constructor.
class ComplianceCache {
 public:
  /// @param compliance  outlives this
  /// @param most        vertices at a time
  ComplianceCache(const Compliance& compliance, int most);

  /// Computes the blocks among these vertices that are missing.
  /// @pre no vertex twice, and at most as many as the constructor was given
  void bring(std::span<const int> vertices);

  /// The slot that holds the rows of a vertex of the last bring().
  [[nodiscard]] int slot_of(int vertex) const { return slot_of_vertex_[vertex]; }
  /// Displacement of the vertex in slot i per force at the vertex in slot j, m/N.
  [[nodiscard]] Eigen::Matrix3f block(int i, int j) const {
    return blocks_.block<3, 3>(3 * i, 3 * j);
  }
  /// All blocks: row and column 3 i + d belong to component d at slot i. Slots without a vertex of
  /// the last bring() hold arbitrary numbers.
  [[nodiscard]] const Eigen::MatrixXf& blocks() const { return blocks_; }

 private:
  void compute(int slot);
  [[nodiscard]] Eigen::Matrix3f block_of(int vertex, int other);
  [[nodiscard]] std::span<const float> targets_at(int slot, int from, int to);

  const Compliance& compliance_;
  int most_;
  std::vector<int> slot_of_vertex_;  // (V) -1: in no slot
  std::vector<int> vertex_of_slot_;  // (most) -1: free
  std::vector<char> wanted_;         // (most) 1: holds a vertex of this bring()
  std::vector<float> basis_;         // (3 most x k) rows of P
  Eigen::MatrixXf blocks_;           // (3 most x 3 most)
  std::vector<char> has_target_;     // (most x C) 1: targets_ is computed
  std::vector<float> targets_;       // (most x C x 3 x k) of unit forces in x, y, z
};

}  // namespace palpable

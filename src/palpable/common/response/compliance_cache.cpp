#include "palpable/common/response/compliance_cache.h"

#include "palpable/common/base/contract.h"

#include <algorithm>
#include <cstddef>

namespace palpable {

using Eigen::Matrix3f;

ComplianceCache::ComplianceCache(const Compliance& compliance, int most)
    : compliance_(compliance),
      most_(most),
      slot_of_vertex_(static_cast<std::size_t>(compliance.vertices()), -1),
      vertex_of_slot_(static_cast<std::size_t>(most), -1),
      wanted_(static_cast<std::size_t>(most), 0),
      basis_(static_cast<std::size_t>(3 * most) * compliance.rank()),
      blocks_(Eigen::MatrixXf::Zero(3 * most, 3 * most)),
      has_target_(static_cast<std::size_t>(most) * static_cast<std::size_t>(compliance.clusters())),
      targets_(3 * has_target_.size() * compliance.rank()) {}

void ComplianceCache::bring(std::span<const int> vertices) {
  PALPABLE_EXPECT(static_cast<int>(vertices.size()) <= most_, "as many vertices as there is room");
  std::fill(wanted_.begin(), wanted_.end(), char{0});
  for (const int v : vertices) {
    if (slot_of_vertex_[v] >= 0) wanted_[slot_of_vertex_[v]] = 1;
  }
  int next = 0;
  for (const int v : vertices) {
    if (slot_of_vertex_[v] >= 0) continue;
    while (wanted_[next] != 0) ++next;
    if (const int old = vertex_of_slot_[next]; old >= 0) slot_of_vertex_[old] = -1;
    vertex_of_slot_[next] = v;
    slot_of_vertex_[v] = next;
    wanted_[next] = 1;
    compute(next);
  }
}

// Displacement of the vertex with the higher number per force at the one with the lower number, in
// that order always, so that a block does not depend on which of them came first.
Matrix3f ComplianceCache::block_of(int vertex, int other) {
  const int low = std::min(vertex, other), high = std::max(vertex, other);
  const int from = compliance_.cluster_of(low), to = compliance_.cluster_of(high);
  Matrix3f block = Matrix3f::Zero();
  if (!compliance_.are_far(from, to)) {
    const std::span<const int> near = compliance_.neighbours(low);
    const auto at = std::lower_bound(near.begin(), near.end(), high);
    if (at == near.end() || *at != high) return block;
    return compliance_.near_block(low, static_cast<std::size_t>(at - near.begin()));
  }
  const std::size_t k = compliance_.rank();
  const std::span<const float> targets = targets_at(slot_of_vertex_[low], from, to);
  for (std::size_t d = 0; d < 3; ++d) {
    block.col(static_cast<int>(d)) = compliance_.at(high, targets.subspan(d * k, k));
  }
  return block;
}

// Targets in the far cluster `to` by unit forces in x, y, z at the slot's vertex, of cluster
// `from`.
std::span<const float> ComplianceCache::targets_at(int slot, int from, int to) {
  const std::size_t k = compliance_.rank(), row = 3 * static_cast<std::size_t>(slot) * k;
  const std::size_t at =
      static_cast<std::size_t>(slot) * static_cast<std::size_t>(compliance_.clusters()) +
      static_cast<std::size_t>(to);
  const std::span<float> targets(targets_.data() + 3 * at * k, 3 * k);
  if (has_target_[at] != 0) return targets;
  has_target_[at] = 1;
  std::fill(targets.begin(), targets.end(), 0.0f);
  for (std::size_t d = 0; d < 3; ++d) {
    compliance_.add_target(from, {basis_.data() + row + d * k, k}, to, targets.subspan(d * k, k));
  }
  return targets;
}

// Computes the blocks between one slot and all slots that hold a vertex.
void ComplianceCache::compute(int slot) {
  const int vertex = vertex_of_slot_[slot];
  const std::size_t k = compliance_.rank();
  const auto C = static_cast<std::ptrdiff_t>(compliance_.clusters());
  std::fill_n(has_target_.begin() + slot * C, C, char{0});
  for (int d = 0; d < 3; ++d) {
    const std::span<float> row(
        basis_.data() + (3 * static_cast<std::size_t>(slot) + static_cast<std::size_t>(d)) * k, k);
    std::fill(row.begin(), row.end(), 0.0f);
    compliance_.add_source(vertex, Eigen::Vector3f::Unit(d), row);
  }
  for (int there = 0; there < most_; ++there) {
    const int other = vertex_of_slot_[there];
    if (other < 0) continue;
    const Matrix3f block = block_of(vertex, other);  // displacement of the higher one
    const int high = other > vertex ? there : slot, low = other > vertex ? slot : there;
    blocks_.block<3, 3>(3 * high, 3 * low) = block;
    if (high != low) blocks_.block<3, 3>(3 * low, 3 * high) = block.transpose();
  }
}

}  // namespace palpable

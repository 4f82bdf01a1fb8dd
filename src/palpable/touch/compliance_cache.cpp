#include "palpable/touch/compliance_cache.h"

#include "palpable/base/contract.h"
#include "palpable/touch/row_kernels.h"

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
      modes_(static_cast<std::size_t>(3 * most) * static_cast<std::size_t>(compliance.rank())),
      codes_(modes_.size()),
      blocks_(Eigen::MatrixXf::Zero(3 * most, 3 * most)),
      products_(static_cast<std::size_t>(6 * most)) {}

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

// The blocks of one slot with all that are taken.
void ComplianceCache::compute(int slot) {
  const RowKernels& kernels = row_kernels().front();
  const auto R = static_cast<std::size_t>(compliance_.rank());
  const int vertex = vertex_of_slot_[slot];
  const ComplianceTable& table = compliance_.table();
  const std::size_t at = 3 * static_cast<std::size_t>(slot) * R;
  const auto expand = [&](const std::vector<std::int16_t>& rows, const std::vector<float>& scale,
                          std::vector<float>& to) {
    std::fill_n(to.begin() + static_cast<std::ptrdiff_t>(at), 3 * R, 0.0f);
    for (std::size_t d = 0; d < 3; ++d) {
      const std::size_t row = 3 * static_cast<std::size_t>(vertex) + d;
      kernels.add(rows.data() + row * R, scale[row], {to.data() + at + d * R, R});
    }
  };
  expand(table.modes, table.mode_scale, modes_);
  expand(table.codes, table.code_scale, codes_);
  // G is symmetric, and Phi C^T nearly: the mean of both ways.
  for (int d = 0; d < 3; ++d) {
    const std::size_t row = at + static_cast<std::size_t>(d) * R;
    for (int other = 0; other < most_; ++other) {
      if (vertex_of_slot_[other] < 0) continue;
      const std::size_t theirs = 3 * static_cast<std::size_t>(other) * R;
      float* products = products_.data();
      kernels.dots_floats(modes_.data() + theirs, 3, {codes_.data() + row, R}, products);
      kernels.dots_floats(codes_.data() + theirs, 3, {modes_.data() + row, R}, products + 3);
      for (int c = 0; c < 3; ++c) {
        blocks_(3 * other + c, 3 * slot + d) = 0.5f * (products[c] + products[3 + c]);
      }
    }
  }
  // Of each pair the table of the lower vertex counts: the two differ by their rounding, and the
  // blocks shall not depend on which vertex came first.
  const std::span<const int> near = compliance_.neighbours(vertex);
  for (std::size_t k = 0; k < near.size(); ++k) {
    const int other = slot_of_vertex_[near[k]];
    if (other < 0) continue;
    if (near[k] >= vertex) {
      blocks_.block<3, 3>(3 * other, 3 * slot) += compliance_.near_block(vertex, k);
      continue;
    }
    const std::span<const int> theirs = compliance_.neighbours(near[k]);
    const auto here = std::lower_bound(theirs.begin(), theirs.end(), vertex);
    if (here == theirs.end() || *here != vertex) continue;
    blocks_.block<3, 3>(3 * other, 3 * slot) +=
        compliance_.near_block(near[k], static_cast<std::size_t>(here - theirs.begin()))
            .transpose();
  }
  for (int other = 0; other < most_; ++other) {
    if (other == slot || vertex_of_slot_[other] < 0) continue;
    blocks_.block<3, 3>(3 * slot, 3 * other) =
        Matrix3f(blocks_.block<3, 3>(3 * other, 3 * slot)).transpose();
  }
}

}  // namespace palpable

#include "palpable/touch/nonlinear_answer.h"

#include "palpable/base/contract.h"
#include "palpable/touch/row_kernels.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace palpable {
namespace {

using Eigen::Matrix3Xf;
using Eigen::Vector3f;

// A region that answered in the last frame is kept if it covers this share of what the best would.
constexpr float kKeep = 0.8f;
// A load at the edge of a region's reach counts this much less than one in its middle.
constexpr float kEdge = 0.3f;
// What is added to the distance of vertices whose normals point apart: the two sides of an ear.
constexpr float kOtherSide = 0.03f;

const RowKernels& kernels() { return row_kernels().front(); }

std::size_t index(int i) { return static_cast<std::size_t>(i); }

}  // namespace

RegionMap::RegionMap(const Matrix3Xf& vertices, const Matrix3Xf& normals,
                     std::span<const RegionTable> regions, double reach)
    : reach_(reach) {
  first_.push_back(0);
  for (int v = 0; v < vertices.cols(); ++v) {
    RegionAtVertex nearest{-1, std::numeric_limits<float>::infinity()};
    for (std::size_t k = 0; k < regions.size(); ++k) {
      const int middle = regions[k].vertex;
      const bool apart = normals.col(v).dot(normals.col(middle)) < -0.2f;
      const float distance =
          (vertices.col(v) - vertices.col(middle)).norm() + (apart ? kOtherSide : 0.0f);
      const bool known =
          std::binary_search(regions[k].vertices.begin(), regions[k].vertices.end(), v);
      if (!known) continue;
      const RegionAtVertex here{static_cast<int>(k), distance};
      if (distance < static_cast<float>(reach)) list_.push_back(here);
      if (distance < nearest.distance) nearest = here;
    }
    if (static_cast<int>(list_.size()) == first_.back() && nearest.region >= 0) {
      list_.push_back(nearest);
    }
    std::sort(list_.begin() + first_.back(), list_.end(),
              [](const auto& a, const auto& b) { return a.distance < b.distance; });
    first_.push_back(static_cast<int>(list_.size()));
  }
}

NonlinearAnswer::NonlinearAnswer(const Compliance& compliance, std::span<const RegionTable> regions,
                                 const RegionMap& map, const CrossTable& cross)
    : compliance_(compliance), regions_(regions), map_(map), cross_(cross) {
  int most_modes = 0, most_leading = 0;
  for (const RegionTable& region : regions) {
    most_modes = std::max(most_modes, region.mode_count());
    most_leading = std::max(most_leading, region.leading());
  }
  const std::size_t R = index(compliance.rank()), x = index(cross.cubic.variables);
  chosen_.reserve(kMostBlobs);
  blob_of_vertex_.assign(index(compliance.vertices()), -1);
  asked_.reserve(index(compliance.vertices()));
  answers_.assign(kMostBlobs, RegionAnswer(most_modes, most_leading));
  score_.resize(regions.size());
  shapes_.resize(kMostBlobs * R);
  code_.resize(index(most_modes));
  far_code_.resize(R);
  region_code_.resize(kMostBlobs * R);
  cross_codes_.resize((kMostBlobs + 1) * x);
  cross_cubic_ = FormRows(cross.cubic);
  pairs_.resize(cross_cubic_.width());
  for (const RegionTable& region : regions) {
    cubic_.emplace_back(region.cubic);
    quartic_.emplace_back(region.quartic);
  }
  cross_q_.resize(x);
}

// The region that covers most of the weight that is left, -1 if none covers any.
int NonlinearAnswer::next_region(std::span<const int> vertices, std::span<const float> weights,
                                 std::span<const int> before) {
  std::fill(score_.begin(), score_.end(), 0.0f);
  const auto reach = static_cast<float>(map_.reach());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    if (!(weights[i] > 0) || blob_of_vertex_[vertices[i]] >= 0) continue;
    for (const RegionAtVertex& near : map_.at(vertices[i])) {
      score_[index(near.region)] +=
          weights[i] * (1 - kEdge * std::min(1.0f, near.distance / reach));
    }
  }
  const auto best = std::max_element(score_.begin(), score_.end());
  if (best == score_.end() || !(*best > 0)) return -1;
  for (const int region : before) {
    if (score_[index(region)] >= kKeep * *best) return region;
  }
  return static_cast<int>(best - score_.begin());
}

void NonlinearAnswer::choose_blobs(std::span<const int> vertices, std::span<const float> weights,
                                   std::span<const int> before) {
  for (const int v : asked_) blob_of_vertex_[v] = -1;
  asked_.assign(vertices.begin(), vertices.end());
  chosen_.clear();
  while (chosen_.size() < kMostBlobs) {
    const int region = next_region(vertices, weights, before);
    if (region < 0) break;
    const int blob = static_cast<int>(chosen_.size());
    chosen_.push_back(region);
    for (const int v : vertices) {
      for (const RegionAtVertex& near : map_.at(v)) {
        if (near.region == region && blob_of_vertex_[v] < 0) blob_of_vertex_[v] = blob;
      }
    }
  }
  for (const int v : vertices) {
    if (blob_of_vertex_[v] >= 0) continue;
    for (std::size_t b = 0; b < chosen_.size() && blob_of_vertex_[v] < 0; ++b) {
      if (row_of(chosen_[b], v) >= 0) blob_of_vertex_[v] = static_cast<int>(b);
    }
  }
}

int NonlinearAnswer::row_of(int region, int vertex) const {
  const std::vector<int>& known = regions_[index(region)].vertices;
  const auto at = std::lower_bound(known.begin(), known.end(), vertex);
  return at != known.end() && *at == vertex ? static_cast<int>(at - known.begin()) : -1;
}

bool NonlinearAnswer::add_mode_row(int blob, int vertex, const Vector3f& direction,
                                   std::span<float> row) const {
  const int region = chosen_[index(blob)];
  const int at = row_of(region, vertex);
  if (at < 0) return false;
  const RoundedRows& modes = regions_[index(region)].modes;
  for (std::size_t d = 0; d < 3; ++d) {
    const std::size_t r = 3 * index(at) + d;
    kernels().add(modes.values.data() + r * modes.width,
                  direction[static_cast<int>(d)] * modes.scale[r], row);
  }
  return true;
}

void NonlinearAnswer::evaluate(std::span<const VertexForce> loads) {
  const std::size_t R = index(compliance_.rank());
  std::fill(far_code_.begin(), far_code_.end(), 0.0f);
  std::fill(shapes_.begin(), shapes_.begin() + static_cast<std::ptrdiff_t>(chosen_.size() * R),
            0.0f);
  last_share_ = 0;
  for (std::size_t b = 0; b < chosen_.size(); ++b) {
    const RegionTable& region = regions_[index(chosen_[b])];
    const std::size_t r = index(region.mode_count());
    const std::span<float> code(code_.data(), r);
    std::fill(code.begin(), code.end(), 0.0f);
    for (const VertexForce& load : loads) {
      if (blob_of_vertex_[load.vertex] != static_cast<int>(b)) continue;
      add_mode_row(static_cast<int>(b), load.vertex, load.force, code);
      if (chosen_.size() > 1) {
        compliance_.add_shape(load.vertex, load.force, {shapes_.data() + b * R, R});
      }
    }
    answers_[b].evaluate({cubic_[index(chosen_[b])], quartic_[index(chosen_[b])]}, code);
    last_share_ = std::max(last_share_, answers_[b].last_share());
    const std::span<float> in_modes(region_code_.data() + b * R, R);
    std::fill(in_modes.begin(), in_modes.end(), 0.0f);
    for (std::size_t k = 0; k < r; ++k) {
      kernels().add(region.from_compliance.values.data() + k * R,
                    answers_[b].q()[k] * region.from_compliance.scale[k], in_modes);
    }
    for (std::size_t k = 0; k < R; ++k) far_code_[k] += in_modes[k];
  }
  if (chosen_.size() > 1 && cross_.cubic.variables > 0) evaluate_cross_terms();
}

// q_x, added to the far code: its modes are smooth everywhere.
void NonlinearAnswer::evaluate_cross_terms() {
  const std::size_t R = index(compliance_.rank()), x = index(cross_.cubic.variables);
  const RoundedRows& modes = cross_.from_compliance;
  std::fill(pairs_.begin(), pairs_.end(), 0.0f);
  const std::span<float> sum(cross_codes_.data() + chosen_.size() * x, x);
  std::fill(sum.begin(), sum.end(), 0.0f);
  for (std::size_t b = 0; b < chosen_.size(); ++b) {
    const std::span<float> c(cross_codes_.data() + b * x, x);
    kernels().dots(modes.values.data(), x, {shapes_.data() + b * R, R}, c.data());
    for (std::size_t i = 0; i < x; ++i) {
      c[i] *= modes.scale[i];
      sum[i] += c[i];
    }
    add_pairs(c, 0.5f, pairs_);
  }
  add_pairs(sum, -0.5f, pairs_);
  cross_cubic_.contract(pairs_, cross_q_);
  for (std::size_t i = 0; i < x; ++i) {
    kernels().add(modes.values.data() + i * R, cross_q_[i] * modes.scale[i], far_code_);
  }
}

Vector3f NonlinearAnswer::displacement_at(int vertex) const {
  const std::size_t R = index(compliance_.rank());
  Vector3f u = Vector3f::Zero();
  bool alone = false;  // the only blob's region knows the vertex: nothing comes from afar
  for (std::size_t b = 0; b < chosen_.size(); ++b) {
    const int at = row_of(chosen_[b], vertex);
    if (at < 0) continue;
    alone = chosen_.size() == 1;
    const RoundedRows& modes = regions_[index(chosen_[b])].modes;
    const std::size_t row = 3 * index(at);
    Vector3f exact;
    kernels().dots(modes.values.data() + row * modes.width, 3, answers_[b].q(), exact.data());
    u += exact.cwiseProduct(Eigen::Map<const Vector3f>(modes.scale.data() + row));
    if (!alone) u -= compliance_.modes_at(vertex, {region_code_.data() + b * R, R});
  }
  return alone ? u : u + compliance_.modes_at(vertex, far_code_);
}

void NonlinearAnswer::add_near(Matrix3Xf& u) const {
  const std::size_t R = index(compliance_.rank());
  for (std::size_t b = 0; b < chosen_.size(); ++b) {
    const RegionTable& region = regions_[index(chosen_[b])];
    const RoundedRows& modes = region.modes;
    for (std::size_t k = 0; k < region.vertices.size(); ++k) {
      Vector3f exact;
      kernels().dots(modes.values.data() + 3 * k * modes.width, 3, answers_[b].q(), exact.data());
      u.col(region.vertices[k]) +=
          exact.cwiseProduct(Eigen::Map<const Vector3f>(modes.scale.data() + 3 * k)) -
          compliance_.modes_at(region.vertices[k], {region_code_.data() + b * R, R});
    }
  }
}

}  // namespace palpable

#include "palpable/common/response/nonlinear_response.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/row_kernels.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace palpable {
namespace {

// Bound on the norm of the cross terms q_x, as a ratio to the norm of all patches' coordinates. It
// is not taken of the sum of the coordinates, which nearly cancels where finger and thumb squeeze.
constexpr float kCrossEnd = 0.5f;
// Relative change (L2) of the coordinates below which the cross terms are not evaluated anew.
constexpr float kSameLoads = 0.02f;

using Eigen::Matrix3Xf;
using Eigen::Vector3f;

// A region of the last frame is kept if it covers at least this ratio of the weight that the best
// region covers. Larger: regions change more often, and with them the error jumps.
constexpr float kKeep = 0.8f;
// Ratio to the reach of a region within which a vertex may join it: the loads from which a region's
// modes were made reach beyond the middle of the press.
constexpr float kJoins = 1.4f;
// Share of its weight that a vertex at the edge of that distance loses when regions are chosen.
constexpr float kEdge = 0.8f;

std::size_t index(int i) { return static_cast<std::size_t>(i); }

}  // namespace

RegionMap::RegionMap(const Matrix3Xf& vertices, std::span<const RegionTable> regions, double reach)
    : reach_(reach) {
  first_.push_back(0);
  for (int v = 0; v < vertices.cols(); ++v) {
    RegionAtVertex nearest{-1, std::numeric_limits<float>::infinity()};
    for (std::size_t k = 0; k < regions.size(); ++k) {
      const int middle = regions[k].vertex;
      const float distance = (vertices.col(v) - vertices.col(middle)).norm();
      const bool known =
          std::binary_search(regions[k].vertices.begin(), regions[k].vertices.end(), v);
      if (!known) continue;
      const RegionAtVertex here{static_cast<int>(k), distance};
      if (distance < kJoins * static_cast<float>(reach)) list_.push_back(here);
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

CrossTable leading(const CrossTable& table, int modes) {
  if (table.cubic.variables <= modes) return table;
  CrossTable result{{}, leading(table.cubic, modes)};
  RoundedRows& rows = result.modes;
  rows.width = index(modes);
  rows.scale = table.modes.scale;
  rows.values.reserve(rows.count() * rows.width);
  for (std::size_t row = 0; row < rows.count(); ++row) {
    const std::int16_t* from = table.modes.row(row);
    rows.values.insert(rows.values.end(), from, from + modes);
  }
  return result;
}

NonlinearResponse::NonlinearResponse(const Compliance& compliance,
                                     std::span<const RegionTable> regions, const RegionMap& map,
                                     const CrossTable& cross)
    : compliance_(compliance), regions_(regions), map_(map), cross_(leading(cross, kCrossModes)) {
  int most_modes = 0, most_leading = 0;
  for (const RegionTable& region : regions) {
    most_modes = std::max(most_modes, region.mode_count());
    most_leading = std::max(most_leading, region.leading());
  }
  const std::size_t C = index(compliance.clusters()), k = compliance.rank();
  const std::size_t x = index(cross_.cubic.variables);
  std::size_t most_shapes = 0;
  own_cluster_.assign(regions.size() * C, 0);
  queried_cluster_.assign(C, 0);
  every_cluster_.assign(C, 1);
  for (std::size_t region = 0; region < regions.size(); ++region) {
    most_shapes = std::max(most_shapes, regions[region].far_count());
    for (const int v : regions[region].vertices) {
      own_cluster_[region * C + index(compliance.cluster_of(v))] = 1;
    }
  }
  chosen_.reserve(kMostPatches);
  patch_of_vertex_.assign(index(compliance.vertices()), -1);
  queried_.reserve(index(compliance.vertices()));
  responses_.assign(kMostPatches, RegionResponse(most_modes, most_leading));
  score_.resize(regions.size());
  most_modes_ = index(most_modes);
  coordinates_.resize(kMostPatches * most_modes_);
  far_targets_.resize(C * k);
  far_coordinates_.resize(most_shapes);
  arriving_.resize(k);
  cross_coordinates_.resize((kMostPatches + 1) * x);
  cross_coordinates_before_.resize(kMostPatches * x);
  cross_cubic_ = FormRows(cross_.cubic);
  pairs_.resize(cross_cubic_.width());
  for (const RegionTable& region : regions) {
    cubic_.emplace_back(region.cubic);
    quartic_.emplace_back(region.quartic);
  }
  cross_q_.resize(x);
}

// The region that covers most of the weight that is not assigned yet; -1 if none covers any.
int NonlinearResponse::next_region(std::span<const int> vertices, std::span<const float> weights,
                                   std::span<const int> before) {
  std::fill(score_.begin(), score_.end(), 0.0f);
  const float farthest = kJoins * static_cast<float>(map_.reach());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    if (!(weights[i] > 0) || patch_of_vertex_[vertices[i]] >= 0) continue;
    for (const RegionAtVertex& near : map_.at(vertices[i])) {
      const float share = std::min(1.0f, near.distance / farthest);
      score_[index(near.region)] += weights[i] * (1 - kEdge * share * share);
    }
  }
  const auto best = std::max_element(score_.begin(), score_.end());
  if (best == score_.end() || !(*best > 0)) return -1;
  for (const int region : before) {
    if (score_[index(region)] >= kKeep * *best) return region;
  }
  return static_cast<int>(best - score_.begin());
}

void NonlinearResponse::choose_patches(std::span<const int> vertices,
                                       std::span<const float> weights,
                                       std::span<const int> before) {
  for (const int v : queried_) patch_of_vertex_[v] = -1;
  queried_.assign(vertices.begin(), vertices.end());
  std::fill(queried_cluster_.begin(), queried_cluster_.end(), char{0});
  for (const int v : vertices) queried_cluster_[index(compliance_.cluster_of(v))] = 1;
  chosen_.clear();
  while (chosen_.size() < kMostPatches) {
    const int region = next_region(vertices, weights, before);
    if (region < 0) break;
    const int patch = static_cast<int>(chosen_.size());
    chosen_.push_back(region);
    for (const int v : vertices) {
      for (const RegionAtVertex& near : map_.at(v)) {
        if (near.region == region && patch_of_vertex_[v] < 0) patch_of_vertex_[v] = patch;
      }
    }
  }
  for (const int v : vertices) {
    if (patch_of_vertex_[v] >= 0) continue;
    for (std::size_t b = 0; b < chosen_.size() && patch_of_vertex_[v] < 0; ++b) {
      if (row_of(chosen_[b], v) >= 0) patch_of_vertex_[v] = static_cast<int>(b);
    }
  }
}

int NonlinearResponse::row_of(int region, int vertex) const {
  const std::vector<int>& known = regions_[index(region)].vertices;
  const auto at = std::lower_bound(known.begin(), known.end(), vertex);
  return at != known.end() && *at == vertex ? static_cast<int>(at - known.begin()) : -1;
}

bool NonlinearResponse::add_mode_row(int patch, int vertex, const Vector3f& direction,
                                     std::span<float> row) const {
  const int region = chosen_[index(patch)];
  const int at = row_of(region, vertex);
  if (at < 0) return false;
  const RoundedRows& modes = regions_[index(region)].modes;
  add_rows(modes, 3 * index(at), {direction.data(), 3}, row);
  return true;
}

void NonlinearResponse::evaluate(std::span<const VertexForce> loads, CrossTerms cross) {
  std::fill(far_targets_.begin(), far_targets_.end(), 0.0f);
  last_share_ = 0;
  for (std::size_t b = 0; b < chosen_.size(); ++b) {
    const RegionTable& region = regions_[index(chosen_[b])];
    const std::span<float> coordinates(coordinates_.data() + b * most_modes_,
                                       index(region.mode_count()));
    std::fill(coordinates.begin(), coordinates.end(), 0.0f);
    for (const VertexForce& load : loads) {
      if (patch_of_vertex_[load.vertex] == static_cast<int>(b) && !load.force.isZero(0)) {
        add_mode_row(static_cast<int>(b), load.vertex, load.force, coordinates);
      }
    }
    responses_[b].evaluate({cubic_[index(chosen_[b])], quartic_[index(chosen_[b])]}, coordinates);
    last_share_ = std::max(last_share_, responses_[b].last_share());
    add_far_targets(chosen_[b], responses_[b].q(), queried_cluster_);
  }
  if (has_cross_terms() && cross == CrossTerms::kAnew) evaluate_cross_terms(loads);
}

void NonlinearResponse::find_far_targets() {
  std::fill(far_targets_.begin(), far_targets_.end(), 0.0f);
  for (std::size_t b = 0; b < chosen_.size(); ++b) {
    add_far_targets(chosen_[b], responses_[b].q(), every_cluster_);
  }
}

// Adds the targets of a region's modes in those of the given clusters that are not the region's
// own.
void NonlinearResponse::add_far_targets(int region, std::span<const float> q,
                                        std::span<const char> clusters) {
  const RegionTable& table = regions_[index(region)];
  const std::size_t C = index(compliance_.clusters()), k = compliance_.rank();
  const std::span<float> coordinates(far_coordinates_.data(), table.far_count());
  best_row_kernels().dots(table.far_shares.row(0), coordinates.size(), q, coordinates.data());
  for (std::size_t j = 0; j < coordinates.size(); ++j) coordinates[j] *= table.far_shares.scale[j];
  std::size_t row = 0;
  for (std::size_t to = 0; to < C; ++to) {
    if (own_cluster_[index(region) * C + to] != 0) continue;
    const std::size_t first = row;
    row += k;
    if (clusters[to] == 0) continue;
    best_row_kernels().dots(table.far_shapes.row(first), k, coordinates, arriving_.data());
    float* target = far_targets_.data() + to * k;
    for (std::size_t i = 0; i < k; ++i) {
      target[i] += table.far_shapes.scale[first + i] * arriving_[i];
    }
  }
}

bool NonlinearResponse::has_cross_terms() const {
  return chosen_.size() > 1 && cross_.cubic.variables > 0;
}

void NonlinearResponse::evaluate_cross_terms(std::span<const VertexForce> loads) {
  const std::size_t x = cross_.modes.width;
  std::fill(cross_coordinates_.begin(), cross_coordinates_.end(), 0.0f);
  const auto coordinates_of = [&](std::size_t b) {
    return std::span<float>(cross_coordinates_.data() + b * x, x);
  };
  for (const VertexForce& load : loads) {
    const int patch = patch_of_vertex_[load.vertex];
    if (patch < 0 || load.force.isZero(0)) continue;
    add_rows(cross_.modes, 3 * index(load.vertex), {load.force.data(), 3},
             coordinates_of(index(patch)));
  }
  const std::size_t count = chosen_.size() * x;
  if (cross_patches_ == chosen_.size()) {
    float change = 0, all = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const float by = cross_coordinates_[i] - cross_coordinates_before_[i];
      change += by * by;
      all += cross_coordinates_[i] * cross_coordinates_[i];
    }
    if (change <= kSameLoads * kSameLoads * all) return;
  }
  cross_patches_ = chosen_.size();
  std::copy_n(cross_coordinates_.begin(), count, cross_coordinates_before_.begin());
  std::fill(pairs_.begin(), pairs_.end(), 0.0f);
  const std::span<float> sum = coordinates_of(chosen_.size());
  for (std::size_t b = 0; b < chosen_.size(); ++b) {
    for (std::size_t i = 0; i < x; ++i) sum[i] += coordinates_of(b)[i];
    add_pairs(coordinates_of(b), 0.5f, pairs_);
  }
  add_pairs(sum, -0.5f, pairs_);
  cross_cubic_.contract(pairs_, cross_q_);
  // A second order that is not small against the first means nothing: it is bounded.
  float first = 0, second = 0;
  for (std::size_t i = 0; i < count; ++i) first += cross_coordinates_[i] * cross_coordinates_[i];
  for (const float q : cross_q_) second += q * q;
  const float most = kCrossEnd * kCrossEnd * first;
  if (second > most) {
    for (float& q : cross_q_) q *= std::sqrt(most / second);
  }
}

Vector3f NonlinearResponse::displacement_at(int vertex) const {
  const std::size_t k = compliance_.rank();
  Vector3f u = compliance_.beyond_at(
      vertex, std::span(far_targets_).subspan(index(compliance_.cluster_of(vertex)) * k, k));
  for (std::size_t b = 0; b < chosen_.size(); ++b) {
    const int at = row_of(chosen_[b], vertex);
    if (at >= 0) u += at_node(regions_[index(chosen_[b])].modes, index(at), responses_[b].q());
  }
  if (has_cross_terms()) u += at_node(cross_.modes, index(vertex), cross_q_);
  return u;
}

void NonlinearResponse::add_near(Eigen::Ref<Matrix3Xf> u) const {
  for (std::size_t b = 0; b < chosen_.size(); ++b) {
    const RegionTable& region = regions_[index(chosen_[b])];
    for (std::size_t k = 0; k < region.vertices.size() && region.vertices[k] < u.cols(); ++k) {
      u.col(region.vertices[k]) += at_node(region.modes, k, responses_[b].q());
    }
  }
}

void NonlinearResponse::add_cross(Eigen::Ref<Matrix3Xf> u) const {
  if (!has_cross_terms()) return;
  for (int v = 0; v < u.cols(); ++v) u.col(v) += at_node(cross_.modes, index(v), cross_q_);
}

}  // namespace palpable

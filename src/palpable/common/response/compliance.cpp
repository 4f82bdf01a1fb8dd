#include "palpable/common/response/compliance.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/row_kernels.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <utility>

namespace palpable {
namespace {

using Eigen::Matrix3f;

// Largest number of a vertex's neighbours: the size of the near field's buffer. trouble_of()
// refuses more.
constexpr std::size_t kMostNeighbours = 16384;
constexpr std::int64_t kMostRank = 256;
// Largest number of clusters: the table of pairs has its square as many entries.
constexpr int kMostClusters = 4096;

bool is_table(const RoundedRows& rows, std::int64_t count, std::int64_t width) {
  return static_cast<std::int64_t>(rows.width) == width && std::ssize(rows.scale) == count &&
         std::ssize(rows.values) == count * width;
}

bool has_bad_clusters(const ComplianceTable& t) {
  if (t.nodes() < t.vertices || t.far_first.size() != t.far_second.size()) return true;
  if (std::any_of(t.cluster_of.begin(), t.cluster_of.end(),
                  [&](int c) { return c < 0 || c >= t.clusters; })) {
    return true;
  }
  for (std::size_t k = 0; k < t.far_first.size(); ++k) {
    const std::pair here(t.far_first[k], t.far_second[k]);
    if (here.first < 0 || here.first >= here.second || here.second >= t.clusters) return true;
    if (k > 0 && here <= std::pair(t.far_first[k - 1], t.far_second[k - 1])) return true;
  }
  return false;
}

}  // namespace

std::string_view trouble_of(const ComplianceTable& t) {
  const std::int64_t V = t.vertices, W = t.nodes(), k = static_cast<std::int64_t>(t.basis.width);
  if (V < 1 || t.clusters < 1 || t.clusters > kMostClusters || k < 1 || k > kMostRank ||
      k % static_cast<std::int64_t>(kRowStep) != 0) {
    return "its size";
  }
  if (has_bad_clusters(t)) return "its clusters";
  if (!is_table(t.basis, 3 * W, k) || !is_table(t.beyond, 3 * W, k) ||
      !is_table(t.couplings, k * std::ssize(t.far_first), k)) {
    return "the size of its far field";
  }
  if (std::ssize(t.first) != V + 1 || std::ssize(t.near_scale) != V || t.first.front() != 0 ||
      t.first.back() != std::ssize(t.neighbours)) {
    return "its lists of neighbours";
  }
  std::int64_t numbers = 0;
  for (std::int64_t v = 0; v < V; ++v) {
    const std::int64_t count = t.first[v + 1] - std::int64_t{t.first[v]};
    if (count < 0 || count > static_cast<std::int64_t>(kMostNeighbours) ||
        t.first[v + 1] > std::ssize(t.neighbours)) {
      return "its lists of neighbours";
    }
    for (std::int64_t n = t.first[v]; n < t.first[v + 1]; ++n) {
      const bool rises = n == t.first[v] || t.neighbours[n] > t.neighbours[n - 1];
      if (t.neighbours[n] < 0 || t.neighbours[n] >= W || !rises) return "its lists of neighbours";
    }
    numbers += 9 * static_cast<std::int64_t>(padded(static_cast<std::size_t>(count)));
  }
  return numbers == std::ssize(t.near) ? std::string_view() : "the size of its near field";
}

Compliance::Compliance(const ComplianceTable& table) : table_(table) {
  PALPABLE_EXPECT(trouble_of(table_).empty(), "a compliance table is consistent");
  std::size_t at = 0;
  for (int v = 0; v < table_.vertices; ++v) {
    near_first_.push_back(at);
    at += 9 * padded(neighbours(v).size());
  }
  const auto C = static_cast<std::size_t>(table_.clusters);
  pair_of_.assign(C * C, -1);
  for (std::size_t p = 0; p < table_.far_first.size(); ++p) {
    const auto c = static_cast<std::size_t>(table_.far_first[p]);
    const auto d = static_cast<std::size_t>(table_.far_second[p]);
    pair_of_[c * C + d] = pair_of_[d * C + c] = static_cast<int>(p);
  }
}

void Compliance::add_source(int vertex, const Eigen::Vector3f& force,
                            std::span<float> source) const {
  add_rows(table_.basis, 3 * static_cast<std::size_t>(vertex), {force.data(), 3}, source);
}

void Compliance::add_target(int from, std::span<const float> source, int to,
                            std::span<float> target) const {
  const RoundedRows& S = table_.couplings;
  const std::size_t first = static_cast<std::size_t>(pair(from, to)) * rank();
  if (from < to) {  // S_cd is stored for c < d; target = S_cd^T source adds up its rows
    add_rows(S, first, source.first(rank()), target);
    return;
  }
  std::array<float, kMostRank> products;
  best_row_kernels().dots(S.row(first), rank(), source, products.data());
  for (std::size_t i = 0; i < rank(); ++i) target[i] += products[i] * S.scale[first + i];
}

Eigen::Vector3f Compliance::at(int node, std::span<const float> target) const {
  return at_node(table_.basis, static_cast<std::size_t>(node), target);
}

Eigen::Vector3f Compliance::beyond_at(int node, std::span<const float> target) const {
  return at_node(table_.beyond, static_cast<std::size_t>(node), target);
}

void Compliance::everywhere(std::span<const float> targets, Eigen::Ref<Eigen::Matrix3Xf> u) const {
  PALPABLE_EXPECT(u.cols() <= nodes(), "a field has three values a node");
  for (int n = 0; n < u.cols(); ++n) {
    u.col(n) = at(n, targets.subspan(static_cast<std::size_t>(cluster_of(n)) * rank(), rank()));
  }
}

void Compliance::add_beyond(std::span<const float> targets, Eigen::Ref<Eigen::Matrix3Xf> u) const {
  PALPABLE_EXPECT(u.cols() <= nodes(), "a field has three values a node");
  for (int n = 0; n < u.cols(); ++n) {
    u.col(n) +=
        beyond_at(n, targets.subspan(static_cast<std::size_t>(cluster_of(n)) * rank(), rank()));
  }
}

void Compliance::add_near(std::span<const VertexForce> loads,
                          Eigen::Ref<Eigen::Matrix3Xf> u) const {
  std::array<float, kMostNeighbours> sum;  // of one displacement component at a time
  for (std::size_t first = 0; first < loads.size();) {
    const int vertex = loads[first].vertex;
    const std::span<const int> near = neighbours(vertex);  // the same for all vertices of a cluster
    const std::size_t width = padded(near.size());
    const auto count = static_cast<std::size_t>(
        std::lower_bound(near.begin(), near.end(), static_cast<int>(u.cols())) - near.begin());
    std::size_t last = first + 1;
    while (last < loads.size() && cluster_of(loads[last].vertex) == cluster_of(vertex)) ++last;
    for (std::size_t c = 0; c < 3; ++c) {
      const std::span<float> sums(sum.data(), padded(count));
      std::fill(sums.begin(), sums.end(), 0.0f);
      for (const VertexForce& load : loads.subspan(first, last - first)) {
        const Eigen::Vector3f scaled = table_.near_scale[load.vertex] * load.force;
        best_row_kernels().add_rows(table_.near.data() + near_first_[load.vertex] + c * width,
                                    3 * width, {scaled.data(), 3}, sums);
      }
      for (std::size_t k = 0; k < count; ++k) u(static_cast<int>(c), near[k]) += sum[k];
    }
    first = last;
  }
}

Eigen::Matrix3f Compliance::near_block(int vertex, std::size_t k) const {
  const std::size_t width = padded(neighbours(vertex).size());
  const std::int16_t* rows = table_.near.data() + near_first_[vertex] + k;
  Eigen::Matrix3f block;
  for (int d = 0; d < 3; ++d) {
    for (int c = 0; c < 3; ++c) {
      block(c, d) = static_cast<float>(rows[static_cast<std::size_t>(3 * d + c) * width]);
    }
  }
  return table_.near_scale[vertex] * block;
}

LinearField::LinearField(const Compliance& compliance)
    : compliance_(compliance),
      sources_(static_cast<std::size_t>(compliance.clusters()) * compliance.rank()),
      targets_(sources_.size()),
      is_source_(static_cast<std::size_t>(compliance.clusters())) {
  by_cluster_.reserve(static_cast<std::size_t>(compliance.vertices()));
}

void LinearField::fill(std::span<const VertexForce> loads, const Eigen::Ref<Eigen::Matrix3Xf>& u) {
  const std::size_t k = compliance_.rank();
  const auto C = static_cast<std::size_t>(compliance_.clusters());
  const auto of = [k](std::vector<float>& numbers, std::size_t cluster) {
    return std::span<float>(numbers.data() + cluster * k, k);
  };
  std::fill(sources_.begin(), sources_.end(), 0.0f);
  std::fill(is_source_.begin(), is_source_.end(), char{0});
  by_cluster_.clear();
  for (const VertexForce& load : loads) {
    if (!load.force.isZero(0)) by_cluster_.push_back(load);
  }
  std::sort(by_cluster_.begin(), by_cluster_.end(), [&](const auto& a, const auto& b) {
    const int c = compliance_.cluster_of(a.vertex), d = compliance_.cluster_of(b.vertex);
    return c != d ? c < d : a.vertex < b.vertex;
  });
  for (const VertexForce& load : by_cluster_) {
    const auto cluster = static_cast<std::size_t>(compliance_.cluster_of(load.vertex));
    is_source_[cluster] = 1;
    compliance_.add_source(load.vertex, load.force, of(sources_, cluster));
  }
  std::fill(targets_.begin(), targets_.end(), 0.0f);
  for (std::size_t from = 0; from < C; ++from) {
    if (is_source_[from] == 0) continue;
    for (std::size_t to = 0; to < C; ++to) {
      if (!compliance_.are_far(static_cast<int>(from), static_cast<int>(to))) continue;
      compliance_.add_target(static_cast<int>(from), of(sources_, from), static_cast<int>(to),
                             of(targets_, to));
    }
  }
  compliance_.everywhere(targets_, u);
  compliance_.add_near(by_cluster_, u);
}

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

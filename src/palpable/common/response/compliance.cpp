#include "palpable/common/response/compliance.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/row_kernels.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

namespace palpable {
namespace {

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

}  // namespace palpable

#include "palpable/touch_bake/compliance_maker.h"

#include "palpable/base/parallel_work.h"
#include "palpable/separate/dense_algebra.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kSamples = 640;    // vertices whose loads the bases are made from
constexpr int kTogether = 48;    // loads of one piece of work: three batches of the factor
constexpr double kRidge = 1e-7;  // of the mean of what tells sources apart
// Of the mean square of targets, which are off by 2e-5 of the largest: what they hold below that is
// rounding.
constexpr double kInnerRidge = 1e-8;
constexpr double kLargest = 32767.0;
constexpr double kNowhere = 1e9;  // m

// What of the table is settled before any load is answered, and where numbers go.
struct Plan {
  ComplianceTable table;
  std::vector<int> middles;               // (C) vertices
  std::vector<std::vector<int>> members;  // (C) vertices, rising
  std::vector<std::vector<int>> inner;    // (C) inner nodes, rising
  std::vector<std::vector<int>> near;     // (C) clusters near each, itself among them, rising
  std::vector<std::size_t> near_first;    // (V) where the nine rows of a vertex begin
};

// The numbers of a part of `fields`: of these nodes, of which `first` is the field's first.
template <class Fields>
Fields rows_of(const Fields& fields, const std::vector<int>& nodes, int first = 0) {
  Fields rows(3 * static_cast<Index>(nodes.size()), fields.cols());
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    rows.middleRows(3 * static_cast<Index>(k), 3) =
        fields.middleRows(3 * Index{nodes[k] - first}, 3);
  }
  return rows;
}

// Each inner node to the cluster of the vertex nearest to it that is not held: a held one tells
// nothing of what moves beside it.
void find_inner_nodes(const SkinResponse& skin, Plan& plan) {
  Eigen::Matrix3Xd X = skin.skin().vertices;
  for (int v = 0; v < skin.vertex_count(); ++v) {
    if (skin.fixed()[v] != 0) X.col(v).setConstant(kNowhere);
  }
  const Eigen::Matrix3Xd nodes = skin.body().model().mesh.nodes + skin.body().rest();
  plan.inner.resize(plan.middles.size());
  for (int n = skin.vertex_count(); n < skin.shell_count(); ++n) {
    Index nearest = 0;
    (X.colwise() - nodes.col(skin.shell_nodes()[n])).colwise().squaredNorm().minCoeff(&nearest);
    const int cluster = plan.table.cluster_of[static_cast<std::size_t>(nearest)];
    plan.table.cluster_of.push_back(cluster);
    plan.inner[cluster].push_back(n);
  }
}

void find_clusters(const SkinResponse& skin, const ComplianceSettings& settings, Plan& plan) {
  const auto& X = skin.skin().vertices;
  plan.middles = spread_vertices(skin, settings.spacing, settings.most);
  plan.table.clusters = static_cast<int>(plan.middles.size());
  plan.members.resize(plan.middles.size());
  plan.near.resize(plan.middles.size());
  double largest = 0;  // m, from a middle
  for (int v = 0; v < skin.vertex_count(); ++v) {
    int best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t c = 0; c < plan.middles.size(); ++c) {
      const double distance = (X.col(v) - X.col(plan.middles[c])).norm();
      if (distance >= least) continue;
      least = distance;
      best = static_cast<int>(c);
    }
    plan.table.cluster_of.push_back(best);
    plan.members[static_cast<std::size_t>(best)].push_back(v);
    if (skin.fixed()[v] == 0) largest = std::max(largest, least);
  }
  const double near = std::max(settings.near_radius, 2 * largest);
  for (int c = 0; c < plan.table.clusters; ++c) {
    for (int d = 0; d < plan.table.clusters; ++d) {
      if ((X.col(plan.middles[c]) - X.col(plan.middles[d])).norm() <= near) {
        plan.near[c].push_back(d);
      } else if (c < d) {
        plan.table.far_first.push_back(c);
        plan.table.far_second.push_back(d);
      }
    }
  }
}

void make_room(Plan& plan, int rank) {
  ComplianceTable& table = plan.table;
  table.first.push_back(0);
  std::size_t numbers = 0;
  for (int v = 0; v < table.vertices; ++v) {
    std::vector<int> neighbours;
    for (const int c : plan.near[table.cluster_of[v]]) {
      neighbours.insert(neighbours.end(), plan.members[c].begin(), plan.members[c].end());
      neighbours.insert(neighbours.end(), plan.inner[c].begin(), plan.inner[c].end());
    }
    std::sort(neighbours.begin(), neighbours.end());
    plan.near_first.push_back(numbers);
    numbers += 9 * padded(neighbours.size());
    table.neighbours.insert(table.neighbours.end(), neighbours.begin(), neighbours.end());
    table.first.push_back(static_cast<int>(table.neighbours.size()));
  }
  table.near.assign(numbers, 0);
  table.near_scale.assign(static_cast<std::size_t>(table.vertices), 0.0f);
  table.couplings.width = static_cast<std::size_t>(rank);
  table.couplings.scale.assign(table.far_first.size() * table.couplings.width, 0.0f);
  table.couplings.values.assign(table.couplings.scale.size() * table.couplings.width, 0);
}

// What loads spread over the skin do, each field divided by its norm on the skin.
struct Samples {
  std::vector<int> vertices;  // three loads each
  MatrixXd skin;              // (3V x loads)
  Eigen::MatrixXf inner;      // (3 (W - V) x loads)
};

Samples sample_fields(const SkinResponse& skin, const ComplianceSettings& settings,
                      const Progress& progress) {
  Samples all{spread_vertices(skin, 0, kSamples), {}, {}};
  const std::vector<int>& samples = all.vertices;
  MatrixXd& fields = all.skin;
  fields.resize(3 * Index{skin.vertex_count()}, 3 * static_cast<Index>(samples.size()));
  all.inner.resize(3 * Index{skin.shell_count()} - fields.rows(), fields.cols());
  const int pieces = static_cast<int>((fields.cols() + kTogether - 1) / kTogether);
  work_in_parallel(pieces, settings.threads, "touch: what is far away", progress, [&](int piece) {
    const Index first = Index{piece} * kTogether;
    const Index count = std::min<Index>(kTogether, fields.cols() - first);
    MatrixXd loads = MatrixXd::Zero(fields.rows(), count);
    for (Index k = 0; k < count; ++k) {
      const int vertex = samples[static_cast<std::size_t>((first + k) / 3)];
      loads(3 * Index{vertex} + (first + k) % 3, k) = 1.0;
    }
    const MatrixXd u = skin.in_shell(skin.body().linear(skin.at_nodes(loads)));
    fields.middleCols(first, count) = u.topRows(fields.rows());
    for (Index k = first; k < first + count; ++k) {
      const double size = std::max(fields.col(k).norm(), std::numeric_limits<double>::min());
      fields.col(k) /= size;
      all.inner.col(k) = (u.col(k - first).tail(all.inner.rows()) / size).cast<float>();
    }
  });
  return all;
}

// Sets to 0 what loads near a cluster do.
template <class Fields>
void clear_near(const Samples& samples, int cluster, const Plan& plan, Fields& here) {
  const std::vector<int>& near = plan.near[cluster];
  for (Index k = 0; k < here.cols(); ++k) {
    const int from = plan.table.cluster_of[samples.vertices[static_cast<std::size_t>(k / 3)]];
    if (std::binary_search(near.begin(), near.end(), from)) here.col(k).setZero();
  }
}

// (3V x k) P, cluster by cluster.
MatrixXd skin_bases(const Samples& samples, int rank, const Plan& plan) {
  MatrixXd P = MatrixXd::Zero(samples.skin.rows(), rank);
  for (int c = 0; c < plan.table.clusters; ++c) {
    MatrixXd here = rows_of(samples.skin, plan.members[c]);
    clear_near(samples, c, plan, here);
    const SymmetricEigen eigen = symmetric_eigen(times(here, here.transpose()));  // increasing
    const Index kept = std::min<Index>(rank, here.rows());
    const MatrixXd basis = eigen.vectors.rightCols(kept).rowwise().reverse();
    for (std::size_t k = 0; k < plan.members[c].size(); ++k) {
      P.block(3 * Index{plan.members[c][k]}, 0, 3, kept) =
          basis.middleRows(3 * static_cast<Index>(k), 3);
    }
  }
  return P;
}

// (3 (W - V) x k) R, cluster by cluster: the least squares of what loads far away do at a cluster's
// inner nodes against their targets there. @param P  (3V x k) as it is kept
MatrixXd inner_bases(const Samples& samples, const MatrixXd& P, const Plan& plan) {
  MatrixXd R = MatrixXd::Zero(samples.inner.rows(), P.cols());
  for (int c = 0; c < plan.table.clusters; ++c) {
    if (plan.inner[c].empty()) continue;
    MatrixXd here = rows_of(samples.skin, plan.members[c]);
    clear_near(samples, c, plan, here);
    const MatrixXd targets = transposed_times(rows_of(P, plan.members[c]), here);
    MatrixXd gram = times(targets, targets.transpose());
    gram.diagonal().array() += kInnerRidge * gram.trace() / static_cast<double>(gram.rows()) +
                               std::numeric_limits<double>::min();
    // What is near has no targets, and is left out by that.
    const MatrixXd inside =
        rows_of(samples.inner, plan.inner[c], plan.table.vertices).cast<double>();
    const MatrixXd basis = gram.llt().solve(times(targets, inside.transpose())).transpose();
    for (std::size_t k = 0; k < plan.inner[c].size(); ++k) {
      R.middleRows(3 * Index{plan.inner[c][k] - plan.table.vertices}, 3) =
          basis.middleRows(3 * static_cast<Index>(k), 3);
    }
  }
  return R;
}

// S_cd for all d > c that are far. @param u  (3W x 3 n_c) what unit loads at c's vertices do
void keep_couplings(const MatrixXd& u, const MatrixXd& P, int c, Plan& plan) {
  ComplianceTable& table = plan.table;
  const MatrixXd mine = rows_of(P, plan.members[c]);
  const auto [begin, end] = std::equal_range(table.far_first.begin(), table.far_first.end(), c);
  for (auto at = begin; at != end; ++at) {
    const auto pair = static_cast<std::size_t>(at - table.far_first.begin());
    const std::vector<int>& there = plan.members[table.far_second[pair]];
    const MatrixXd target = transposed_times(rows_of(P, there), rows_of(u, there));  // (k x 3 n_c)
    const RoundedRows rows = rounded(times(target, mine).transpose().cast<float>());
    const std::size_t first = pair * table.couplings.width;
    std::copy(rows.scale.begin(), rows.scale.end(),
              table.couplings.scale.begin() + static_cast<std::ptrdiff_t>(first));
    std::copy(rows.values.begin(), rows.values.end(),
              table.couplings.values.begin() +
                  static_cast<std::ptrdiff_t>(first * table.couplings.width));
  }
}

// The nine rows of one vertex, from its three answers. @param u  (3W x 3) m/N
void keep_near(const Eigen::Ref<const MatrixXd>& u, int vertex, Plan& plan) {
  ComplianceTable& table = plan.table;
  const auto first = static_cast<std::size_t>(table.first[vertex]);
  const auto last = static_cast<std::size_t>(table.first[vertex + 1]);
  const std::size_t width = padded(last - first);
  double largest = 0;
  for (std::size_t k = first; k < last; ++k) {
    largest =
        std::max(largest, u.middleRows(3 * Index{table.neighbours[k]}, 3).cwiseAbs().maxCoeff());
  }
  const double scale = largest / kLargest;
  table.near_scale[vertex] = static_cast<float>(scale);
  if (!(scale > 0)) return;
  for (std::size_t k = first; k < last; ++k) {
    for (int d = 0; d < 3; ++d) {
      for (int c = 0; c < 3; ++c) {
        table.near[plan.near_first[vertex] + static_cast<std::size_t>(3 * d + c) * width + k -
                   first] =
            static_cast<std::int16_t>(
                std::lround(u(3 * Index{table.neighbours[k]} + c, d) / scale));
      }
    }
  }
}

}  // namespace

ComplianceTable make_compliance(const SkinResponse& skin, const ComplianceSettings& settings,
                                const Progress& progress) {
  Plan plan;
  plan.table.vertices = skin.vertex_count();
  find_clusters(skin, settings, plan);
  find_inner_nodes(skin, plan);
  make_room(plan, settings.rank);
  MatrixXd P;
  {
    const Samples samples = sample_fields(skin, settings, progress);
    RoundedRows& basis = plan.table.basis;
    basis = rounded(skin_bases(samples, settings.rank, plan).cast<float>());
    P = as_numbers(basis);
    const RoundedRows inner = rounded(inner_bases(samples, P, plan).cast<float>());
    basis.values.insert(basis.values.end(), inner.values.begin(), inner.values.end());
    basis.scale.insert(basis.scale.end(), inner.scale.begin(), inner.scale.end());
  }
  work_in_parallel(plan.table.clusters, settings.threads, "touch: compliance of every vertex",
                   progress, [&](int c) {
                     const std::vector<int>& members = plan.members[c];
                     MatrixXd loads = MatrixXd::Zero(3 * Index{plan.table.vertices},
                                                     3 * static_cast<Index>(members.size()));
                     for (Index k = 0; k < loads.cols(); ++k) {
                       loads(3 * Index{members[static_cast<std::size_t>(k / 3)]} + k % 3, k) = 1.0;
                     }
                     const MatrixXd u = skin.in_shell(skin.body().linear(skin.at_nodes(loads)));
                     keep_couplings(u, P, c, plan);
                     for (std::size_t k = 0; k < members.size(); ++k) {
                       keep_near(u.middleCols(3 * static_cast<Index>(k), 3), members[k], plan);
                     }
                   });
  return std::move(plan.table);
}

MatrixXd sources_of(const Compliance& compliance, const std::vector<int>& clusters,
                    const MatrixXd& fields) {
  const auto k = static_cast<Index>(compliance.rank());
  const MatrixXd P = as_numbers(compliance.table().basis);
  std::vector<std::vector<int>> members(static_cast<std::size_t>(compliance.clusters()));
  for (int v = 0; v < compliance.vertices(); ++v) members[compliance.cluster_of(v)].push_back(v);
  const Index unknowns = k * static_cast<Index>(clusters.size());
  MatrixXd gram = MatrixXd::Zero(unknowns, unknowns);
  MatrixXd right = MatrixXd::Zero(unknowns, fields.cols());
  for (int d = 0; d < compliance.clusters(); ++d) {
    if (std::any_of(clusters.begin(), clusters.end(),
                    [&](int c) { return !compliance.are_far(c, d); })) {
      continue;
    }
    MatrixXd arrives(k, unknowns);  // at d, by a unit of each source
    std::vector<float> source(compliance.rank()), target(compliance.rank());
    for (Index j = 0; j < unknowns; ++j) {
      std::fill(source.begin(), source.end(), 0.0f);
      std::fill(target.begin(), target.end(), 0.0f);
      source[static_cast<std::size_t>(j % k)] = 1.0f;
      compliance.add_target(clusters[static_cast<std::size_t>(j / k)], source, d, target);
      arrives.col(j) = Eigen::Map<const Eigen::VectorXf>(target.data(), k).cast<double>();
    }
    add_gram(arrives, gram);
    right += transposed_times(
        arrives, transposed_times(rows_of(P, members[d]), rows_of(fields, members[d])));
  }
  gram.diagonal().array() +=
      kRidge * gram.trace() / static_cast<double>(unknowns) + std::numeric_limits<double>::min();
  return gram.selfadjointView<Eigen::Lower>().llt().solve(right);
}

}  // namespace palpable

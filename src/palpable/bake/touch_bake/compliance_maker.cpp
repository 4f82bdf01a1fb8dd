#include "palpable/bake/touch_bake/compliance_maker.h"

#include "palpable/bake/separate/dense_algebra.h"
#include "palpable/common/base/parallel_work.h"
#include "palpable/common/base/row_kernels.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;

constexpr int kSamples = 640;        // vertices with point loads, for the bases
constexpr int kSecondSamples = 240;  // vertices with pressure patches, for the second order
constexpr double kPatch = 0.007;     // m, radius of these patches
constexpr int kTogether = 48;        // loads of one work item: three batches of the factor
// Ridge of the fit of R, as a ratio to the mean square of the targets. Targets are rounded to 2e-5
// of the largest; a smaller ridge would fit that rounding.
constexpr double kInnerRidge = 1e-8;
constexpr double kLargest = 32767.0;  // the 16-bit number that stands for a vertex's largest entry
constexpr double kNowhere = 1e9;      // m: a position that is never the nearest

// The parts of the table that are known before any solve, and where its numbers are stored.
struct Plan {
  ComplianceTable table;
  std::vector<int> middles;               // (C) vertices
  std::vector<std::vector<int>> members;  // (C) vertices, rising
  std::vector<std::vector<int>> inner;    // (C) inner nodes, rising
  std::vector<std::vector<int>> near;     // (C) clusters near each, itself among them, rising
  std::vector<std::size_t> near_first;    // (V) where the nine rows of a vertex begin
};

// The rows of `fields` that belong to these nodes. @param first  the node of the first three rows
template <class Fields>
Fields rows_of_fields(const Fields& fields, const std::vector<int>& nodes, int first = 0) {
  Fields rows(3 * static_cast<Index>(nodes.size()), fields.cols());
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    rows.middleRows(3 * static_cast<Index>(k), 3) =
        fields.middleRows(3 * Index{nodes[k] - first}, 3);
  }
  return rows;
}

// Assigns each inner node to the cluster of the nearest vertex that is not held: the displacement
// of a held vertex is zero and says nothing about that of the node beside it.
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
  double largest = 0;  // m: of the distances of free vertices from their cluster's middle
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

// Displacements under loads spread over the skin: those of the first order, then those of the
// second order under other loads. Each field is divided by its norm on the skin.
struct Samples {
  std::vector<int> vertices;  // at which the loads act; three fields for each
  Index linear = 0;           // number of fields of the first order; they come first
  MatrixXd skin;              // (3V x loads)
  Eigen::MatrixXf inner;      // (3 (W - V) x loads)
};

// (3V x 3) three loads on the skin around a vertex: along its normal, and tilted in two directions.
MatrixXd patches_at(const SkinResponse& skin, int vertex) {
  constexpr double kAskew = 0.5;
  const Vector3d in = -skin.mean_normal(vertex, kPatch);
  const Vector3d t = in.unitOrthogonal(), s = in.cross(t);
  MatrixXd loads = MatrixXd::Zero(3 * Index{skin.vertex_count()}, 3);
  for (int v = 0; v < skin.vertex_count(); ++v) {
    const double r = skin.distance(v, vertex) / kPatch;
    if (r >= 1 || skin.fixed()[v] != 0) continue;
    loads.middleRows(3 * Index{v}, 3) << (1 - r * r) * in, (1 - r * r) * (in + kAskew * t),
        (1 - r * r) * (in + kAskew * s);
  }
  return loads;
}

// (3N x loads) the displacement of second order under each of these loads.
MatrixXd second_order(const LoadResponse& body, const MatrixXd& loads) {
  const MatrixXd u = body.linear(loads);
  MatrixXd force(u.rows(), u.cols());
  for (Index k = 0; k < u.cols(); ++k) {
    force.col(k) = -body.second_force(u.col(k)).cwiseProduct(body.free_mask());
  }
  return body.linear(force);
}

Samples sample_fields(const SkinResponse& skin, const ComplianceSettings& settings,
                      const Progress& progress) {
  Samples all{spread_vertices(skin, 0, kSamples), 0, {}, {}};
  const auto linear = static_cast<Index>(all.vertices.size());
  const std::vector<int> places = spread_vertices(skin, 0, kSecondSamples);
  all.vertices.insert(all.vertices.end(), places.begin(), places.end());
  const auto samples = static_cast<Index>(all.vertices.size());
  all.linear = 3 * linear;
  all.skin.resize(3 * Index{skin.vertex_count()}, 3 * samples);
  all.inner.resize(3 * Index{skin.shell_count()} - all.skin.rows(), all.skin.cols());
  constexpr Index kVertices = kTogether / 3;  // of one piece
  const Index linear_pieces = (linear + kVertices - 1) / kVertices;
  const Index pieces = linear_pieces + (samples - linear + kVertices - 1) / kVertices;
  const auto solve_piece = [&](int piece) {
    const bool is_linear = piece < linear_pieces;
    const Index first =
        is_linear ? piece * kVertices : linear + (piece - linear_pieces) * kVertices;
    const Index count = std::min(kVertices, (is_linear ? linear : samples) - first);
    MatrixXd loads = MatrixXd::Zero(all.skin.rows(), 3 * count);
    for (Index k = 0; k < count; ++k) {
      const int vertex = all.vertices[static_cast<std::size_t>(first + k)];
      if (is_linear) {
        loads.block<3, 3>(3 * Index{vertex}, 3 * k).setIdentity();
      } else {
        loads.middleCols(3 * k, 3) = patches_at(skin, vertex);
      }
    }
    const MatrixXd at_nodes = skin.at_nodes(loads);
    const MatrixXd u = skin.in_shell(is_linear ? skin.body().linear(at_nodes)
                                               : second_order(skin.body(), at_nodes));
    for (Index k = 0; k < u.cols(); ++k) {
      const auto on_skin = u.col(k).head(all.skin.rows());
      const double size = std::max(on_skin.norm(), std::numeric_limits<double>::min());
      all.skin.col(3 * first + k) = on_skin / size;
      all.inner.col(3 * first + k) = (u.col(k).tail(all.inner.rows()) / size).cast<float>();
    }
  };
  work_in_parallel(static_cast<int>(pieces), settings.threads, "touch: bases of the clusters",
                   progress, solve_piece);
  return all;
}

// Sets the fields of loads near a cluster to 0.
template <class Fields>
void clear_near(const Samples& samples, int cluster, const Plan& plan, Fields& here) {
  const std::vector<int>& near = plan.near[cluster];
  for (Index k = 0; k < here.cols(); ++k) {
    const int from = plan.table.cluster_of[samples.vertices[static_cast<std::size_t>(k / 3)]];
    if (std::binary_search(near.begin(), near.end(), from)) here.col(k).setZero();
  }
}

// (3V x k) P, cluster by cluster, from the first `fields` of the samples.
MatrixXd skin_bases(const Samples& samples, Index fields, int rank, const Plan& plan) {
  MatrixXd P = MatrixXd::Zero(samples.skin.rows(), rank);
  for (int c = 0; c < plan.table.clusters; ++c) {
    MatrixXd here = rows_of_fields(samples.skin, plan.members[c]).leftCols(fields);
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

// (3 (W - V) x k) R, cluster by cluster, from the first `fields` of the samples: the least squares
// fit of the displacements that far loads cause at a cluster's inner nodes by their targets there.
// @param P  (3V x k) after rounding, as the table stores it
MatrixXd inner_bases(const Samples& samples, Index fields, const MatrixXd& P, const Plan& plan) {
  MatrixXd R = MatrixXd::Zero(samples.inner.rows(), P.cols());
  for (int c = 0; c < plan.table.clusters; ++c) {
    if (plan.inner[c].empty()) continue;
    MatrixXd here = rows_of_fields(samples.skin, plan.members[c]).leftCols(fields);
    clear_near(samples, c, plan, here);
    const MatrixXd targets = transposed_times(rows_of_fields(P, plan.members[c]), here);
    MatrixXd gram = times(targets, targets.transpose());
    gram.diagonal().array() += kInnerRidge * gram.trace() / static_cast<double>(gram.rows()) +
                               std::numeric_limits<double>::min();
    // The fields of near loads have zero targets, so that they do not contribute to the product.
    const MatrixXd inside = rows_of_fields(samples.inner, plan.inner[c], plan.table.vertices)
                                .leftCols(fields)
                                .cast<double>();
    const MatrixXd basis = gram.llt().solve(times(targets, inside.transpose())).transpose();
    for (std::size_t k = 0; k < plan.inner[c].size(); ++k) {
      R.middleRows(3 * Index{plan.inner[c][k] - plan.table.vertices}, 3) =
          basis.middleRows(3 * static_cast<Index>(k), 3);
    }
  }
  return R;
}

// The low-rank bases of compliance_table.h, from the first `fields` columns of the samples (one
// displacement field each): P of the W vertices of the skin, (3W x k), and below it R of the nodes
// inside.
RoundedRows bases(const Samples& samples, Index fields, int rank, const Plan& plan) {
  RoundedRows all = rounded(skin_bases(samples, fields, rank, plan).cast<float>());
  const RoundedRows inner =
      rounded(inner_bases(samples, fields, as_numbers(all), plan).cast<float>());
  all.values.insert(all.values.end(), inner.values.begin(), inner.values.end());
  all.scale.insert(all.scale.end(), inner.scale.begin(), inner.scale.end());
  return all;
}

// Stores S_cd for all d > c that are far from c.
// @param u  (3W x 3 n_c) m/N, displacements under unit loads at c's vertices
void keep_couplings(const MatrixXd& u, const MatrixXd& P, int c, Plan& plan) {
  ComplianceTable& table = plan.table;
  const MatrixXd mine = rows_of_fields(P, plan.members[c]);
  const auto [begin, end] = std::equal_range(table.far_first.begin(), table.far_first.end(), c);
  for (auto at = begin; at != end; ++at) {
    const auto pair = static_cast<std::size_t>(at - table.far_first.begin());
    const std::vector<int>& there = plan.members[table.far_second[pair]];
    const MatrixXd target =
        transposed_times(rows_of_fields(P, there), rows_of_fields(u, there));  // (k x 3 n_c)
    const RoundedRows rows = rounded(times(target, mine).transpose().cast<float>());
    const std::size_t first = pair * table.couplings.width;
    std::copy(rows.scale.begin(), rows.scale.end(),
              table.couplings.scale.begin() + static_cast<std::ptrdiff_t>(first));
    std::copy(rows.values.begin(), rows.values.end(),
              table.couplings.values.begin() +
                  static_cast<std::ptrdiff_t>(first * table.couplings.width));
  }
}

// Stores the nine rows of one vertex. @param u  (3W x 3) m/N, displacements under its unit loads
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

// Everything that is known before a solve: clusters, neighbours, and room for the numbers.
Plan plan_of(const SkinResponse& skin, const ComplianceSettings& settings) {
  Plan plan;
  plan.table.vertices = skin.vertex_count();
  find_clusters(skin, settings, plan);
  find_inner_nodes(skin, plan);
  make_room(plan, settings.rank);
  return plan;
}

}  // namespace

int solves_of_bases(int vertices) {
  return 3 * std::min(vertices, kSamples) + 6 * std::min(vertices, kSecondSamples);
}

ComplianceTable compliance_without_numbers(const SkinResponse& skin,
                                           const ComplianceSettings& settings) {
  ComplianceTable table = plan_of(skin, settings).table;
  const std::size_t rows = 3 * static_cast<std::size_t>(table.nodes());
  const auto width = static_cast<std::size_t>(settings.rank);
  table.basis = {width, std::vector<std::int16_t>(rows * width, 0), std::vector<float>(rows, 0.0f)};
  table.beyond = table.basis;
  return table;
}

ComplianceTable make_compliance(const SkinResponse& skin, const ComplianceSettings& settings,
                                const Progress& progress) {
  Plan plan = plan_of(skin, settings);
  {
    const Samples samples = sample_fields(skin, settings, progress);
    plan.table.basis = bases(samples, samples.linear, settings.rank, plan);
    plan.table.beyond = bases(samples, samples.skin.cols(), settings.rank, plan);
  }
  const MatrixXd P = as_numbers(plan.table.basis);
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

}  // namespace palpable

#include "bench/bake/sparse_campaign.h"

#include "palpable/base/contract.h"
#include "palpable/base/error.h"
#include "palpable/base/order_statistics.h"
#include "palpable/campaign/store_rows.h"
#include "palpable/describe/body_mesh.h"
#include "palpable/separate/dense_algebra.h"
#include "palpable/separate/pod_coordinates.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// (K) true for a random part; the same for the same seed.
std::vector<bool> draw(Index K, double part, std::uint64_t seed) {
  std::vector<Index> order(K);
  std::iota(order.begin(), order.end(), Index{0});
  std::mt19937_64 random(seed);
  for (Index k = K - 1; k > 0; --k) {
    std::swap(order[k], order[random() % static_cast<std::uint64_t>(k + 1)]);
  }
  const auto count = static_cast<std::size_t>(std::llround(part * static_cast<double>(K)));
  std::vector<bool> drawn(K, false);
  for (std::size_t k = 0; k < count; ++k) drawn[order[k]] = true;
  return drawn;
}

const StoredField& complete_displacement(const SnapshotStore& store) {
  const StoredField* moved = find_field(store.content(), "displacement");
  if (moved == nullptr) {
    throw Error(fmt::format("{}: has no displacement", store.folder().string()));
  }
  for (int s = 0; s < store.content().site_count(); ++s) {
    const std::string why = store.why_not(s);
    if (!why.empty()) throw Error(fmt::format("{}: {}", store.unit_file(s).string(), why));
  }
  return *moved;
}

// (3 x K) x, y of the site and level of each snapshot.
MatrixXd points_of(const StoreContent& content) {
  const Boundary boundary = split_boundary_of(content.mesh);
  const Index L = content.level_count();
  MatrixXd points(3, content.site_count() * L);
  for (Index k = 0; k < points.cols(); ++k) {
    const Site& site = content.sites[k / L];
    points.col(k).head(2) = boundary.surface.vertices.col(site.vertex).head(2);
    points(2, k) = content.levels[k % L + 1];
  }
  return points;
}

// The drawn snapshots, each weighted by the root of the volumes, and where they are.
struct Learnt {
  MatrixXd values;  // (3N x T)
  MatrixXd points;  // (3 x T)
};
Learnt learnt_of(const SnapshotRows& rows, const VectorXd& root, const MatrixXd& points,
                 const std::vector<bool>& drawn) {
  const auto T = static_cast<Index>(std::count(drawn.begin(), drawn.end(), true));
  const int S = rows.sizes[0], L = rows.sizes[1];
  Learnt learnt{MatrixXd(rows.values, T), MatrixXd(3, T)};
  Index t = 0;
  for (int s = 0; s < S; ++s) {
    const Index first = Index{s} * L;
    if (std::none_of(drawn.begin() + first, drawn.begin() + first + L, [](bool d) { return d; })) {
      continue;
    }
    const MatrixXd A = rows.read_first(s);
    for (Index l = 0; l < L; ++l) {
      if (!drawn[first + l]) continue;
      learnt.values.col(t) = root.cwiseProduct(A.col(l));
      learnt.points.col(t++) = points.col(first + l);
    }
  }
  return learnt;
}

// The errors at all snapshots that were not drawn. @param F  (3N x m) weighted by the root
void add_held_out(const SnapshotRows& rows, const VectorXd& root, const MatrixXd& points,
                  const std::vector<bool>& drawn, const MatrixXd& F, SparseCampaign& result) {
  const int S = rows.sizes[0], L = rows.sizes[1];
  double lost = 0, whole = 0;
  std::vector<double> own;
  for (int s = 0; s < S; ++s) {
    MatrixXd A = root.asDiagonal() * rows.read_first(s);
    const VectorXd norms = A.colwise().squaredNorm();
    MatrixXd g(L, F.cols());
    for (Index l = 0; l < L; ++l) {
      g.row(l) = result.model.functions(points.col(Index{s} * L + l)).transpose();
    }
    subtract_product(F, g, A);
    for (Index l = 0; l < L; ++l) {
      if (drawn[Index{s} * L + l]) continue;
      lost += A.col(l).squaredNorm();
      whole += norms[l];
      own.push_back(A.col(l).norm() / std::sqrt(norms[l]));
    }
  }
  result.held_out = std::sqrt(lost / whole);
  result.held_out_worst = *std::max_element(own.begin(), own.end());
  result.held_out_median = upper_median(own);
}

}  // namespace

SparseCampaign sparse_campaign(const SnapshotStore& store, const SparseCampaignSettings& settings,
                               const Progress& progress) {
  PALPABLE_EXPECT(settings.part > 0.0 && settings.part < 1.0, "a part, and a rest");
  const StoreContent& content = store.content();
  const StoredField& moved = complete_displacement(store);
  const SnapshotRows rows = snapshot_rows(store, 0, moved);
  const VectorXd root = value_weights(content.mesh, moved).cwiseSqrt();
  const MatrixXd points = points_of(content);
  const auto axis = [&](const char* name, Index j) {
    return SparseAxis{
        .name = name, .low = points.row(j).minCoeff(), .high = points.row(j).maxCoeff()};
  };
  SparseAxis level{.name = "level",
                   .zero_at_low = true,
                   .highest_degree = std::min(12, content.level_count() - 1)};

  const std::vector<bool> drawn = draw(points.cols(), settings.part, settings.seed);
  const Learnt learnt = learnt_of(rows, root, points, drawn);
  const Index T = learnt.values.cols();
  MatrixXd gram = MatrixXd::Zero(T, T);
  add_gram(learnt.values, gram);
  const PodCoordinates Q = pod_coordinates(gram, VectorXd::Ones(T), 1e-5);

  SparseCampaign result;
  result.samples = static_cast<int>(points.cols());
  result.trained_on = static_cast<int>(T);
  result.model = sparse_pgd(Q.C, learnt.points, {axis("x", 0), axis("y", 1), std::move(level)},
                            settings.sparse, progress);
  const MatrixXd F = times(learnt.values, times(Q.combination, result.model.F));  // likewise
  add_held_out(rows, root, points, drawn, F, result);
  result.model.F = root.cwiseInverse().asDiagonal() * F;
  return result;
}

}  // namespace palpable

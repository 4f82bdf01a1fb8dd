#include "palpable/bake/pipeline/sparse_campaign.h"

#include "palpable/bake/campaign/store_rows.h"
#include "palpable/bake/describe/body_mesh.h"
#include "palpable/bake/separate/dense_algebra.h"
#include "palpable/bake/separate/pod.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/order_statistics.h"
#include "palpable/common/geometry/size_text.h"

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

// (S L) true for `count` snapshots at random; the same for the same seed.
// @param each_site  draws at least one of each site
std::vector<bool> draw(Index S, Index L, Index count, bool each_site, std::uint64_t seed) {
  const Index K = S * L;
  std::vector<Index> order(K);
  std::iota(order.begin(), order.end(), Index{0});
  std::mt19937_64 random(seed);
  for (Index k = K - 1; k > 0; --k) {
    std::swap(order[k], order[random() % static_cast<std::uint64_t>(k + 1)]);
  }
  std::vector<bool> drawn(K, false), has(S, !each_site);
  const auto take = [&](Index k) {
    has[k / L] = true;
    drawn[k] = true;
    --count;
  };
  for (const Index k : order) {
    if (!has[k / L]) take(k);
  }
  for (const Index k : order) {
    if (count > 0 && !drawn[k]) take(k);
  }
  return drawn;
}

// How many snapshots to learn from.
Index training_count(const SnapshotStore& store, const SitePlaces& places,
                     const SparseCampaignSettings& settings) {
  const Index S = store.content().site_count(), K = S * store.content().level_count();
  const auto count = static_cast<Index>(std::llround(settings.part * static_cast<double>(K)));
  const Index least = settings.sparse.folds + (places.quantities ? 0 : S);
  if (count >= least && count < K) return count;
  throw Error(fmt::format(
      "{}: {:.4g} of {} snapshots are {}; sparse PGD learns from at least {}{}, and leaves at "
      "least one to be asked about",
      store.folder().string(), settings.part, K, count, least,
      places.quantities ? "" : ", one of each site and some to compare"));
}

// The drawn snapshots, each weighted by the root of the nodal volumes, and their parameter values.
struct Learnt {
  MatrixXd values;  // (N x T)
  MatrixXd points;  // (a + 1 x T) places, level
};
Learnt learnt_of(const SnapshotRows& rows, const VectorXd& root, const MatrixXd& places,
                 const VectorXd& levels, const std::vector<bool>& drawn) {
  const auto T = static_cast<Index>(std::count(drawn.begin(), drawn.end(), true));
  const int S = rows.sizes[0], L = rows.sizes[1];
  Learnt learnt{MatrixXd(rows.values, T), MatrixXd(places.rows() + 1, T)};
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
      learnt.points.col(t++) << places.col(s), levels[l];
    }
  }
  return learnt;
}

void add_functions(const MatrixXd& places, const VectorXd& levels, SparseCampaign& result) {
  const SparsePgd& model = result.model;
  const Index a = places.rows(), m = model.F.cols();
  result.site_functions = MatrixXd::Ones(places.cols(), m);
  for (Index s = 0; s < places.cols(); ++s) {
    for (Index j = 0; j < a; ++j) {
      result.site_functions.row(s).array() *=
          model.functions_of(j, places(j, s)).transpose().array();
    }
  }
  result.level_functions.resize(levels.size(), m);
  for (Index l = 0; l < levels.size(); ++l) {
    result.level_functions.row(l) = model.functions_of(a, levels[l]).transpose();
  }
}

// Squared norms of what the model misses of some snapshots (`lost`), and of these snapshots
// (`whole`).
struct Losses {
  std::vector<double> lost, whole;

  [[nodiscard]] SnapshotErrors errors() const {
    SnapshotErrors result{.count = static_cast<int>(lost.size())};
    std::vector<double> own = own_errors();
    const double all = std::accumulate(whole.begin(), whole.end(), 0.0);
    if (all > 0.0) {
      result.pooled = std::sqrt(std::accumulate(lost.begin(), lost.end(), 0.0) / all);
    }
    result.worst = *std::max_element(own.begin(), own.end());
    result.median = upper_median(own);
    return result;
  }
  [[nodiscard]] std::vector<double> own_errors() const {
    std::vector<double> own;
    for (std::size_t k = 0; k < lost.size(); ++k) {
      own.push_back(whole[k] > 0.0 ? std::sqrt(lost[k] / whole[k]) : 0.0);
    }
    return own;
  }
};

// @param F  (N x m) weighted by the root
void add_errors(const SnapshotRows& rows, const VectorXd& root, const std::vector<bool>& drawn,
                const MatrixXd& F, SparseCampaign& result) {
  const int S = rows.sizes[0], L = rows.sizes[1];
  Losses all, unseen;
  for (int s = 0; s < S; ++s) {
    MatrixXd A = root.asDiagonal() * rows.read_first(s);
    const VectorXd whole = A.colwise().squaredNorm();
    const MatrixXd g = result.level_functions * result.site_functions.row(s).asDiagonal();
    subtract_product(F, g, A);
    for (Index l = 0; l < L; ++l) {
      const double lost = A.col(l).squaredNorm();
      all.lost.push_back(lost);
      all.whole.push_back(whole[l]);
      if (drawn[Index{s} * L + l]) continue;
      unseen.lost.push_back(lost);
      unseen.whole.push_back(whole[l]);
    }
  }
  result.all = all.errors();
  result.unseen = unseen.errors();
  const std::vector<double> own = all.own_errors();
  result.errors = Eigen::Map<const VectorXd>(own.data(), static_cast<Index>(own.size()));
}

}  // namespace

SitePlaces site_places(const StoreContent& content) {
  const Boundary boundary = split_boundary_of(content.mesh);
  const Eigen::Matrix3Xd& vertices = boundary.surface.vertices;
  const Index S = content.site_count();
  Eigen::Matrix3Xd points(3, S);
  double turned = 0;
  for (Index s = 0; s < S; ++s) {
    points.col(s) = vertices.col(content.sites[s].vertex);
    turned = std::max(turned, (content.sites[s].direction - content.sites[0].direction).norm());
  }
  const double size = extent_of(vertices).maxCoeff();
  std::vector<Index> varied;
  for (Index j = 0; j < 3; ++j) {
    if (points.row(j).maxCoeff() - points.row(j).minCoeff() > 1e-6 * size) varied.push_back(j);
  }
  if (turned <= 1e-6 && (varied.size() == 1 || varied.size() == 2)) {
    SitePlaces places{.quantities = true, .axes = {}, .points = points(varied, Eigen::all)};
    for (const Index j : varied) {
      places.axes.push_back({.name = std::string(1, "xyz"[j]),
                             .low = points.row(j).minCoeff(),
                             .high = points.row(j).maxCoeff()});
    }
    return places;
  }
  return {.quantities = false,
          .axes = {{.name = "site",
                    .basis = SparseAxis::Basis::kNodal,
                    .choices = static_cast<int>(S)}},
          .points = VectorXd::LinSpaced(S, 0.0, static_cast<double>(S) - 1.0).transpose()};
}

SparseCampaign sparse_campaign(const SnapshotStore& store, int point, const StoredField& field,
                               const SparseCampaignSettings& settings, const Progress& progress) {
  PALPABLE_EXPECT(settings.part > 0.0 && settings.part < 1.0, "a part, and a rest");
  const StoreContent& content = store.content();
  const SnapshotRows rows = snapshot_rows(store, point, field);
  const VectorXd root = value_weights(content.mesh, field).cwiseSqrt();
  const Index S = content.site_count(), L = content.level_count();
  const VectorXd levels = content.levels.tail(L);

  SparseCampaign result;
  result.places = site_places(content);
  const std::vector<bool> drawn = draw(S, L, training_count(store, result.places, settings),
                                       !result.places.quantities, settings.seed);
  const Learnt learnt = learnt_of(rows, root, result.places.points, levels, drawn);
  const Index T = learnt.values.cols();
  MatrixXd gram = MatrixXd::Zero(T, T);
  add_gram(learnt.values, gram);
  const PodCoordinates Q = pod_coordinates(gram, VectorXd::Ones(T), 1e-5);

  std::vector<SparseAxis> axes = result.places.axes;
  axes.push_back({.name = "level",
                  .zero_at_low = true,
                  .highest_degree = std::clamp(content.level_count() - 1, 1, 12)});
  SparseSettings sparse = settings.sparse;
  // A mode may improve one site alone, which is a gain S times smaller over all sites.
  if (!result.places.quantities) sparse.least_gain /= static_cast<double>(S);
  result.trained_on = static_cast<int>(T);
  result.model = sparse_pgd(Q.C, learnt.points, std::move(axes), sparse, progress);
  const MatrixXd F = times(learnt.values, times(Q.combination, result.model.F));  // weighted
  result.model.F = root.cwiseInverse().asDiagonal() * F;
  add_functions(result.places.points, levels, result);
  add_errors(rows, root, drawn, F, result);
  return result;
}

}  // namespace palpable

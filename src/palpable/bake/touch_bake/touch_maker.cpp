#include "palpable/bake/touch_bake/touch_maker.h"

#include "palpable/bake/separate/dense_algebra.h"
#include "palpable/bake/touch_bake/shell_maker.h"
#include "palpable/common/base/parallel_work.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;

// Sampling for the form of the cross terms. It is coarser than the default, since these modes are
// smooth and the cross terms small.
constexpr FormSampling kSmooth{.exact = 0.2, .neglect = 1e-3, .every = 8};
constexpr double kNearPair = 0.035;  // m: every second pair of loads is closer together than this

// (3V x 3 places) smooth patches of load at the places, each in three directions.
MatrixXd patches(const SkinResponse& skin, const std::vector<int>& places, double radius) {
  MatrixXd loads =
      MatrixXd::Zero(3 * Index{skin.vertex_count()}, 3 * static_cast<Index>(places.size()));
  for (std::size_t p = 0; p < places.size(); ++p) {
    const Vector3d in = -skin.mean_normal(places[p], radius);
    const Vector3d t = in.unitOrthogonal(), s = in.cross(t);
    for (int v = 0; v < skin.vertex_count(); ++v) {
      const double r = skin.distance(v, places[p]) / radius;
      if (r >= 1 || skin.fixed()[v] != 0) continue;
      const double weight = (1 - r * r) * (1 - r * r);
      const Index column = 3 * static_cast<Index>(p);
      loads.block<3, 1>(3 * Index{v}, column) = weight * in;
      loads.block<3, 1>(3 * Index{v}, column + 1) = weight * t;
      loads.block<3, 1>(3 * Index{v}, column + 2) = weight * s;
    }
  }
  return loads;
}

void scale_columns(MatrixXd& u, MatrixXd& force, const auto& size) {
  for (Index k = 0; k < u.cols(); ++k) {
    const double s = std::max(size(k), 1e-300);
    u.col(k) /= s;
    force.col(k) /= s;
  }
}

}  // namespace

// The modes are a POD in the L2 norm. A POD in the stiffness' norm would spend its modes on sharp
// fields, but the interaction of distant patches is smooth.
CrossTable make_cross_table(const SkinResponse& skin, const ModalFormMaker& forms,
                            const CrossSettings& settings) {
  CrossTable table;
  if (settings.modes == 0) return table;
  const LoadResponse& body = skin.body();
  const std::vector<int> places = spread_vertices(skin, 0, settings.places);
  MatrixXd force = skin.at_nodes(patches(skin, places, settings.radius));
  MatrixXd u = body.linear(force);
  scale_columns(u, force,
                [&](Index k) { return std::sqrt(std::max(0.0, u.col(k).dot(force.col(k)))); });

  std::mt19937_64 random(7);
  std::uniform_int_distribution<std::size_t> any(0, places.size() - 1);
  MatrixXd pair_force(u.rows(), settings.pairs);
  for (Index k = 0; k < pair_force.cols(); ++k) {
    std::size_t a = any(random), b = any(random);
    for (int tries = 0; tries < 1000; ++tries, b = any(random)) {
      if (b != a && (k % 2 == 0 || skin.distance(places[a], places[b]) < kNearPair)) break;
    }
    pair_force.col(k) =
        -body.mixed_force(u.col(3 * static_cast<Index>(a)), u.col(3 * static_cast<Index>(b)))
             .cwiseProduct(body.free_mask());
  }
  MatrixXd pair_u = body.linear(pair_force);
  const auto norm = [](const MatrixXd& field) {
    return [&field](Index k) { return field.col(k).norm(); };
  };
  scale_columns(u, force, norm(u));
  scale_columns(pair_u, pair_force, norm(pair_u));
  MatrixXd all(u.rows(), u.cols() + pair_u.cols()), all_force(all.rows(), all.cols());
  all << u, pair_u;
  all_force << force, pair_force;
  MatrixXd gram = MatrixXd::Zero(all.cols(), all.cols());
  add_gram(all, gram);
  const SymmetricEigen eigen = symmetric_eigen(gram);
  const Index n = std::min<Index>(settings.modes, all.cols());
  const MatrixXd weights = eigen.vectors.rightCols(n).rowwise().reverse();
  const MatrixXd Q = times(all, weights);
  MatrixXd K = transposed_times(Q, times(all_force, weights));
  K = 0.5 * (K + K.transpose().eval());
  MatrixXd modes = MatrixXd::Zero(all.rows(), settings.modes);
  modes.leftCols(n) = K.llt().matrixL().solve(Q.transpose()).transpose();

  table.modes = rounded(skin.in_shell(modes).cast<float>());
  const ModalForms made = forms.make(modes, 0, kSmooth);
  table.cubic = rounded(made.modes, 3, made.cubic);
  return table;
}

namespace {

ComplianceTable find_or_make_compliance(const SkinResponse& skin, const TouchBakeSettings& settings,
                                        const TouchKeys& keys, const Progress& progress,
                                        const TouchStore* store) {
  if (store != nullptr) {
    if (auto kept = store->find_compliance(keys)) return std::move(*kept);
  }
  ComplianceSettings compliance = settings.compliance;
  compliance.threads = settings.threads;
  ComplianceTable made = make_compliance(skin, compliance, progress);
  if (store != nullptr) store->keep(keys, made);
  return made;
}

VibrationTable find_or_make_vibration(const SkinResponse& skin, const InertiaSettings& settings,
                                      const ComplianceTable& compliance, const TouchKeys& keys,
                                      const Progress& progress, const TouchStore* store) {
  if (store != nullptr) {
    if (auto kept = store->find_vibration(keys)) return std::move(*kept);
  }
  VibrationTable made = make_vibration(skin, settings, progress);
  expect_residual_compliance(skin, compliance, made);
  if (store != nullptr) store->keep(keys, made);
  return made;
}

constexpr int kCross = -1;  // stands for the cross terms in a list of numbers of regions

// Reads what the store has into `tables`. @returns numbers of the regions (or kCross) that it lacks
std::vector<int> read_stored(const std::vector<int>& middles, const TouchBakeSettings& settings,
                             const TouchKeys& keys, const TouchStore* store, TouchTables& tables) {
  std::vector<int> missing;
  // The cross terms are one more work item beside the regions. It takes longest, so it comes first.
  if (settings.cross.modes > 0) {
    auto kept = store != nullptr ? store->find_cross(keys) : std::nullopt;
    if (kept) tables.cross = std::move(*kept);
    if (!kept) missing.push_back(kCross);
  }
  tables.regions.resize(middles.size());
  for (std::size_t k = 0; k < middles.size(); ++k) {
    auto kept = store != nullptr ? store->find_region(keys, middles[k]) : std::nullopt;
    if (kept) tables.regions[k] = std::move(*kept);
    if (!kept) missing.push_back(static_cast<int>(k));
  }
  return missing;
}

}  // namespace

TouchTables make_touch_tables(const SkinResponse& skin, const TouchBakeSettings& settings,
                              const Progress& progress, const TouchStore* store) {
  const TouchKeys keys = store != nullptr ? touch_keys(skin, settings) : TouchKeys{};
  TouchTables tables;
  tables.point_spacing = settings.point_spacing;
  tables.friction = settings.friction;
  tables.region_reach = settings.regions.reach;
  tables.shell = make_shell(skin);
  if (store != nullptr && !store->find_shell(keys)) store->keep(keys, tables.shell);
  tables.compliance = find_or_make_compliance(skin, settings, keys, progress, store);
  if (settings.inertia) {
    tables.vibration =
        find_or_make_vibration(skin, *settings.inertia, tables.compliance, keys, progress, store);
  }
  const std::vector<int> middles =
      spread_vertices(skin, settings.regions.spacing, settings.regions.most);
  const std::vector<int> missing = read_stored(middles, settings, keys, store, tables);
  if (missing.empty()) return tables;
  const std::size_t all = middles.size() + (settings.cross.modes > 0 ? 1 : 0);
  const auto there = static_cast<double>(all - missing.size());
  const Progress with_those_kept = [&](const ProgressReport& now) {
    report(progress, {now.task, now.done + there, now.total + there, now.note});
  };
  const ModalFormMaker forms(skin.body().model(), skin.body().rest());
  const Compliance compliance(tables.compliance);
  work_in_parallel(static_cast<int>(missing.size()), settings.threads,
                   "touch: large loads, region by region", with_those_kept, [&](int item) {
                     const int k = missing[static_cast<std::size_t>(item)];
                     if (k == kCross) {
                       tables.cross = make_cross_table(skin, forms, settings.cross);
                       if (store != nullptr) store->keep(keys, tables.cross);
                     } else {
                       RegionTable& region = tables.regions[static_cast<std::size_t>(k)];
                       region = make_region(skin, forms, compliance,
                                            middles[static_cast<std::size_t>(k)], settings.regions);
                       if (store != nullptr) store->keep(keys, region);
                     }
                   });
  return tables;
}

}  // namespace palpable

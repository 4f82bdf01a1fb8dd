#include "palpable/touch_bake/touch_maker.h"

#include "palpable/separate/dense_algebra.h"
#include "palpable/touch_bake/parallel_work.h"

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

// The modes are smooth, and the cross terms small.
constexpr FormSampling kSmooth{.exact = 0.2, .neglect = 1e-3, .every = 8};
constexpr double kNearPair = 0.035;  // m: every second pair of loads lies nearer than this

// Smooth patches at the places, three directions each, (3V x 3 places).
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

// A POD in the L2 norm: one in the norm of the stiffness would spend its modes on what is sharp,
// and what patches do to each other from afar is smooth.
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

  table.modes = rounded(skin.on_skin(modes).cast<float>());
  const ModalForms made = forms.make(modes, 0, kSmooth);
  table.cubic = rounded(made.modes, 3, made.cubic);
  return table;
}

TouchTables make_touch_tables(const SkinResponse& skin, const TouchBakeSettings& settings,
                              const Progress& progress) {
  TouchTables tables;
  tables.point_spacing = settings.point_spacing;
  tables.region_reach = settings.regions.reach;
  ComplianceSettings compliance = settings.compliance;
  compliance.threads = settings.threads;
  tables.compliance = make_compliance(skin, compliance, progress);
  const std::vector<int> middles =
      spread_vertices(skin, settings.regions.spacing, settings.regions.most);
  const ModalFormMaker forms(skin.body().model(), skin.body().rest());
  const Compliance asked(tables.compliance);
  tables.regions.resize(middles.size());
  // The cross terms are one more piece of work beside the regions.
  const int count = static_cast<int>(middles.size());
  work_in_parallel(count + 1, settings.threads, "touch: large loads, region by region", progress,
                   [&](int item) {
                     if (item == 0) {
                       tables.cross = make_cross_table(skin, forms, settings.cross);
                     } else {
                       tables.regions[item - 1] =
                           make_region(skin, forms, asked, middles[item - 1], settings.regions);
                     }
                   });
  return tables;
}

}  // namespace palpable

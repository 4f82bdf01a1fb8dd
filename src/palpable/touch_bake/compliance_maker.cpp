#include "palpable/touch_bake/compliance_maker.h"

#include "palpable/separate/dense_algebra.h"
#include "palpable/touch/region.h"
#include "palpable/touch_bake/parallel_work.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kExtra = 16;     // directions more than are kept: they make the last ones good
constexpr int kRounds = 2;     // of the subspace iteration
constexpr int kProbes = 64;    // random directions that tell how large columns are
constexpr int kTogether = 48;  // loads of one piece of work: three batches of the factor
constexpr double kLargest = 32767.0;
constexpr const char* kModesTask = "touch: modes of the compliance";

// (3V x k) G times loads, in several threads.
MatrixXd answer(const SkinResponse& skin, const MatrixXd& loads, int threads,
                const std::string& task, const Progress& progress) {
  MatrixXd result(loads.rows(), loads.cols());
  const int pieces = static_cast<int>((loads.cols() + kTogether - 1) / kTogether);
  work_in_parallel(pieces, threads, task, progress, [&](int piece) {
    const Index first = Index{piece} * kTogether;
    const Index count = std::min<Index>(kTogether, loads.cols() - first);
    result.middleCols(first, count) =
        skin.on_skin(skin.body().linear(skin.at_nodes(loads.middleCols(first, count))));
  });
  return result;
}

// (3V) 1 / |G_j|, roughly: of k random directions z the mean of (z . G_j)^2 is |G_j|^2, to
// sqrt(2 / k) of it.
VectorXd inverse_norms(const SkinResponse& skin, int threads, std::mt19937_64& random) {
  std::normal_distribution<double> entry;
  const MatrixXd Z =
      MatrixXd::NullaryExpr(3 * Index{skin.vertex_count()}, kProbes, [&] { return entry(random); });
  const VectorXd norms = answer(skin, Z, threads, kModesTask, {}).rowwise().norm();
  const double floor = 1e-6 * norms.maxCoeff();  // held components answer nothing
  return norms.cwiseMax(floor).cwiseInverse();
}

// (3V x R) orthonormal: the leading left singular vectors of G S with S = 1 / |G_j|.
MatrixXd leading_modes(const SkinResponse& skin, const ComplianceSettings& settings,
                       const Progress& progress) {
  const Index rows = 3 * Index{skin.vertex_count()};
  const Index wanted = std::min<Index>(settings.rank + kExtra, rows);
  std::mt19937_64 random(1);
  std::normal_distribution<double> entry;
  const VectorXd S = inverse_norms(skin, settings.threads, random);
  const auto G = [&](const MatrixXd& loads) {
    return answer(skin, loads, settings.threads, kModesTask, progress);
  };
  const MatrixXd start = MatrixXd::NullaryExpr(rows, wanted, [&] { return entry(random); });
  MatrixXd Q = orthonormal_basis(G(S.asDiagonal() * start));
  for (int round = 0; round < kRounds; ++round) {
    const VectorXd S2 = S.cwiseAbs2();
    Q = orthonormal_basis(G(S2.asDiagonal() * G(Q)));
  }
  const MatrixXd SGQ = S.asDiagonal() * G(Q);
  const SymmetricEigen eigen = symmetric_eigen(transposed_times(SGQ, SGQ));  // increasing
  MatrixXd modes = MatrixXd::Zero(rows, settings.rank);
  const Index kept = std::min<Index>(settings.rank, wanted);
  modes.leftCols(kept) = times(Q, eigen.vectors.rightCols(kept).rowwise().reverse());
  return modes;
}

// Neighbours within the radius, rising.
void find_neighbours(const SkinResponse& skin, double radius, ComplianceTable& table) {
  const auto& X = skin.skin().vertices;
  table.first.push_back(0);
  for (int v = 0; v < skin.vertex_count(); ++v) {
    for (int w = 0; w < skin.vertex_count(); ++w) {
      if ((X.col(v) - X.col(w)).norm() <= radius) table.neighbours.push_back(w);
    }
    table.first.push_back(static_cast<int>(table.neighbours.size()));
  }
}

// Rows as they were rounded.
MatrixXd as_rounded(const std::vector<std::int16_t>& values, const std::vector<float>& scale,
                    Index rank) {
  const Eigen::Map<
      const Eigen::Matrix<std::int16_t, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>
      rows(values.data(), static_cast<Index>(scale.size()), rank);
  const Eigen::Map<const Eigen::VectorXf> factor(scale.data(), rows.rows());
  return factor.cast<double>().asDiagonal() * rows.cast<double>();
}

// The nine rows of one vertex, from its three answers.
// @param u       (3V x 3) m/N
// @param modes   (3V x R) Phi, as rounded
// @param codes   (3 x R) C of the vertex, as rounded
void keep_near(const MatrixXd& u, const MatrixXd& modes, const MatrixXd& codes, int vertex,
               std::size_t at, ComplianceTable& table) {
  const auto first = static_cast<std::size_t>(table.first[vertex]);
  const auto last = static_cast<std::size_t>(table.first[vertex + 1]);
  const std::size_t width = padded(last - first);
  MatrixXd rest(3 * static_cast<Index>(last - first), 3);
  for (std::size_t k = first; k < last; ++k) {
    const Index w = 3 * Index{table.neighbours[k]};
    rest.middleRows(3 * static_cast<Index>(k - first), 3) =
        u.middleRows(w, 3) - modes.middleRows(w, 3) * codes.transpose();
  }
  const double largest = rest.cwiseAbs().maxCoeff();
  const double scale = largest / kLargest;
  table.near_scale[vertex] = static_cast<float>(scale);
  if (!(scale > 0)) return;
  for (std::size_t k = first; k < last; ++k) {
    for (int d = 0; d < 3; ++d) {
      for (int c = 0; c < 3; ++c) {
        table.near[at + static_cast<std::size_t>(3 * d + c) * width + k - first] =
            static_cast<std::int16_t>(
                std::lround(rest(3 * static_cast<Index>(k - first) + c, d) / scale));
      }
    }
  }
}

}  // namespace

ComplianceTable make_compliance(const SkinResponse& skin, const ComplianceSettings& settings,
                                const Progress& progress) {
  ComplianceTable table;
  table.vertices = skin.vertex_count();
  table.rank = settings.rank;
  {
    const RoundedRows rows = rounded(leading_modes(skin, settings, progress).cast<float>());
    table.modes = rows.values;
    table.mode_scale = rows.scale;
  }
  const MatrixXd modes = as_rounded(table.modes, table.mode_scale, table.rank);
  table.codes.assign(table.modes.size(), 0);
  table.code_scale.assign(table.mode_scale.size(), 0.0f);
  find_neighbours(skin, settings.near_radius, table);
  std::vector<std::size_t> at{0};
  for (int v = 0; v < table.vertices; ++v) {
    at.push_back(at.back() +
                 9 * padded(static_cast<std::size_t>(table.first[v + 1] - table.first[v])));
  }
  table.near.assign(at.back(), 0);
  table.near_scale.assign(static_cast<std::size_t>(table.vertices), 0.0f);
  const int together = kTogether / 3;
  const int pieces = (table.vertices + together - 1) / together;
  work_in_parallel(
      pieces, settings.threads, "touch: compliance of every vertex", progress, [&](int piece) {
        const int first = piece * together, last = std::min(table.vertices, first + together);
        MatrixXd loads = MatrixXd::Zero(3 * Index{table.vertices}, 3 * Index{last - first});
        for (Index k = 0; k < loads.cols(); ++k) loads(3 * Index{first} + k, k) = 1.0;
        const MatrixXd u = skin.on_skin(skin.body().linear(skin.at_nodes(loads)));
        const RoundedRows codes = rounded(transposed_times(u, modes).cast<float>());
        std::copy(codes.values.begin(), codes.values.end(),
                  table.codes.begin() + 3 * std::ptrdiff_t{first} * table.rank);
        std::copy(codes.scale.begin(), codes.scale.end(),
                  table.code_scale.begin() + 3 * std::ptrdiff_t{first});
        const MatrixXd exact = as_rounded(codes.values, codes.scale, table.rank);
        for (int v = first; v < last; ++v) {
          const Index row = 3 * Index{v - first};
          keep_near(u.middleCols(row, 3), modes, exact.middleRows(row, 3), v, at[v], table);
        }
      });
  return table;
}

}  // namespace palpable

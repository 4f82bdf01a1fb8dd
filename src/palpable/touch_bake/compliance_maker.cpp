#include "palpable/touch_bake/compliance_maker.h"

#include "palpable/separate/dense_algebra.h"
#include "palpable/touch/region.h"
#include "palpable/touch_bake/parallel_work.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kSamples = 640;    // vertices whose loads the modes are made from
constexpr double kFrom = 0.7;    // of the near radius: from there on a field counts, fully at 1
constexpr double kRidge = 1e-6;  // of what tells codes apart: keeps those that nothing tells
constexpr int kTogether = 48;    // loads of one piece of work: three batches of the factor
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

// (3V x R) orthonormal: the leading directions of what loads at single vertices do far away, each
// field divided by its norm.
MatrixXd leading_modes(const SkinResponse& skin, const ComplianceSettings& settings,
                       const Progress& progress) {
  const Index rows = 3 * Index{skin.vertex_count()};
  const std::vector<int> samples = spread_vertices(skin, 0, kSamples);
  MatrixXd loads = MatrixXd::Zero(rows, 3 * static_cast<Index>(samples.size()));
  for (Index k = 0; k < loads.cols(); ++k) {
    loads(3 * Index{samples[static_cast<std::size_t>(k / 3)]} + k % 3, k) = 1.0;
  }
  MatrixXd fields = answer(skin, loads, settings.threads, kModesTask, progress);
  const auto& X = skin.skin().vertices;
  for (Index k = 0; k < fields.cols(); ++k) {
    fields.col(k) /= std::max(fields.col(k).norm(), 1e-300);
    const int middle = samples[static_cast<std::size_t>(k / 3)];
    for (int v = 0; v < skin.vertex_count(); ++v) {
      const double distance = (X.col(v) - X.col(middle)).norm() / settings.near_radius;
      fields.col(k).segment<3>(3 * Index{v}) *=
          std::clamp((distance - kFrom) / (1.0 - kFrom), 0.0, 1.0);
    }
  }
  MatrixXd gram = MatrixXd::Zero(fields.cols(), fields.cols());
  add_gram(fields, gram);
  const SymmetricEigen eigen = symmetric_eigen(gram);  // increasing
  const Index kept = std::min<Index>(settings.rank, gram.cols());
  MatrixXd modes = MatrixXd::Zero(rows, settings.rank);
  modes.leftCols(kept) =
      orthonormal_basis(times(fields, eigen.vectors.rightCols(kept).rowwise().reverse()));
  return modes;
}

// (R x 3) codes of one vertex: Phi C comes nearest to its answers where it has no near field.
// @param u  (3V x 3) m/N
MatrixXd codes_of(const MatrixXd& u, const MatrixXd& modes, std::span<const int> neighbours) {
  MatrixXd near(3 * static_cast<Index>(neighbours.size()), modes.cols());
  MatrixXd near_u(near.rows(), 3);
  for (std::size_t k = 0; k < neighbours.size(); ++k) {
    const Index row = 3 * static_cast<Index>(k), at = 3 * Index{neighbours[k]};
    near.middleRows(row, 3) = modes.middleRows(at, 3);
    near_u.middleRows(row, 3) = u.middleRows(at, 3);
  }
  const MatrixXd all = transposed_times(modes, u);
  MatrixXd gram = MatrixXd::Zero(modes.cols(), modes.cols());
  add_gram(near, gram);
  gram *= -1;
  gram.diagonal().array() += 1 + kRidge;
  // From the whole field's code on, so that the ridge keeps that.
  const MatrixXd rest = transposed_times(near, near * all - near_u);
  return all + gram.selfadjointView<Eigen::Lower>().llt().solve(rest);
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
        MatrixXd all_codes(3 * Index{last - first}, table.rank);
        for (int v = first; v < last; ++v) {
          const std::span<const int> neighbours(table.neighbours.data() + table.first[v],
                                                table.neighbours.data() + table.first[v + 1]);
          all_codes.middleRows(3 * Index{v - first}, 3) =
              codes_of(u.middleCols(3 * Index{v - first}, 3), modes, neighbours).transpose();
        }
        const RoundedRows codes = rounded(all_codes.cast<float>());
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

#include "palpable/bake/touch_bake/vibration_maker.h"

#include "palpable/bake/separate/dense_algebra.h"
#include "palpable/bake/solid/vibration_modes.h"
#include "palpable/common/base/cpu_time.h"
#include "palpable/common/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr int kVerticesCompared = 200;

}  // namespace

VibrationTable make_vibration(const SkinResponse& skin, const InertiaSettings& settings,
                              const Progress& progress) {
  const ProgressReport begin{"touch: vibration modes", 0, 1, {}};
  report(progress, begin);
  const double before = thread_cpu_seconds();
  const LoadResponse& body = skin.body();
  const VibrationModes modes = vibration_modes(body, settings.density,
                                               {.least = std::min(settings.modes, kMostModesMade),
                                                .below = settings.below,
                                                .most = kMostModesMade});
  VibrationTable table;
  table.omega.assign(modes.omega.begin(), modes.omega.end());
  table.shapes = skin.in_shell(modes.shapes).transpose().cast<float>();
  table.loss_factor = settings.loss_factor;
  table.density = settings.density;
  table.mass = settings.density * nodal_volumes(body.model().mesh).sum();
  report(progress,
         {begin.task, 1, 1,
          fmt::format("{} modes, {:.1f} s", table.mode_count(), thread_cpu_seconds() - before)});
  return table;
}

double smallest_residual_compliance(const ComplianceTable& table, const VibrationTable& vibration,
                                    const std::vector<int>& vertices) {
  const Compliance compliance(table);
  ComplianceCache cache(compliance, static_cast<int>(vertices.size()));
  cache.bring(vertices);
  const auto n = 3 * static_cast<Index>(vertices.size());
  MatrixXd G(n, n), scaled_shapes(n, vibration.mode_count());
  for (std::size_t a = 0; a < vertices.size(); ++a) {
    const auto row = 3 * static_cast<Index>(a);
    for (std::size_t b = 0; b < vertices.size(); ++b) {
      G.block<3, 3>(row, 3 * static_cast<Index>(b)) =
          cache.block(cache.slot_of(vertices[a]), cache.slot_of(vertices[b])).cast<double>();
    }
    const MatrixXd here =
        vibration.shapes.middleCols(3 * Index{vertices[a]}, 3).transpose().cast<double>();
    for (Index i = 0; i < here.cols(); ++i) {
      scaled_shapes.block(row, i, 3, 1) =
          here.col(i) / vibration.omega[static_cast<std::size_t>(i)];
    }
  }
  G = 0.5 * (G + G.transpose().eval());
  const double largest = symmetric_eigen(G).values[n - 1];
  subtract_product(scaled_shapes, scaled_shapes, G);
  return symmetric_eigen(G).values[0] / largest;
}

void expect_residual_compliance(const SkinResponse& skin, const ComplianceTable& table,
                                const VibrationTable& vibration) {
  // Of a skin with fewer free vertices some would be chosen twice.
  const auto free = std::count(skin.fixed().begin(), skin.fixed().end(), std::uint8_t{0});
  if (free == 0) return;
  const std::vector<int> vertices =
      spread_vertices(skin, 0, static_cast<int>(std::min<std::ptrdiff_t>(kVerticesCompared, free)));
  const double smallest = smallest_residual_compliance(table, vibration, vertices);
  if (smallest >= -kResidualRounding) return;
  throw Error(fmt::format(
      "the vibration modes give way by more than the skin's compliance does: the "
      "smallest eigenvalue of what is left is {:.2g} of the largest, less than -{:.0e}; "
      "modes = 0 in [touch] leaves modes out",
      smallest, kResidualRounding));
}

}  // namespace palpable

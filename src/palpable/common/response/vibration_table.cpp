#include "palpable/common/response/vibration_table.h"

#include <algorithm>
#include <cmath>

namespace palpable {
namespace {

bool is_above_0(double value) { return std::isfinite(value) && value > 0; }

}  // namespace

std::size_t bytes_of(const VibrationTable& table) {
  return table.omega.size() * sizeof(double) +
         static_cast<std::size_t>(table.shapes.size()) * sizeof(float);
}

std::string_view trouble_of(const VibrationTable& table, int nodes) {
  const std::size_t m = table.omega.size();
  if (m < 1 || m > static_cast<std::size_t>(kMostVibrationModes)) return "their number";
  if (!std::all_of(table.omega.begin(), table.omega.end(), is_above_0) ||
      !std::is_sorted(table.omega.begin(), table.omega.end())) {
    return "their frequencies";
  }
  if (table.shapes.rows() != static_cast<Eigen::Index>(m) ||
      table.shapes.cols() != 3 * Eigen::Index{nodes}) {
    return "the size of their shapes";
  }
  if (!table.shapes.allFinite()) return "a shape, which is not finite";
  if (!(table.loss_factor >= 0 && table.loss_factor < 1)) return "the loss factor";
  if (!is_above_0(table.density)) return "the density";
  if (!is_above_0(table.mass)) return "the mass";
  return {};
}

VibrationTable scaled(const VibrationTable& table, double s) {
  VibrationTable result = table;
  for (double& omega : result.omega) omega /= s;
  result.shapes *= static_cast<float>(std::pow(s, -1.5));
  result.mass *= s * s * s;
  return result;
}

}  // namespace palpable

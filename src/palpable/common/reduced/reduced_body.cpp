#include "palpable/common/reduced/reduced_body.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/reduced/mode_kernels.h"
#include "palpable/common/reduced/spline.h"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double between(const Eigen::Ref<const VectorXd>& x, const Eigen::Ref<const VectorXd>& g,
               const Eigen::Ref<const VectorXd>& slopes, double at) {
  const CubicWeights c = cubic_weights(x, at);
  return c.value[0] * g[c.left] + c.value[1] * slopes[c.left] + c.value[2] * g[c.right] +
         c.value[3] * slopes[c.right];
}

void expect_table(const ReducedBody& body, int site) {
  PALPABLE_EXPECT(site >= 0 && static_cast<std::size_t>(site) < body.sites.size(),
                  "the site exists");
  PALPABLE_EXPECT(body.level_slope.cols() == body.press_depth.cols(), "the press is tabulated");
}

// Interpolates a table over (..., parameter), in which the parameter's samples are neighbouring
// columns, at one value of the parameter.
//   (R x K n) -> (R x K)
MatrixXd at_value(const MatrixXd& table, const VectorXd& samples, double value) {
  const Index n = samples.size(), K = table.cols() / n;
  const CubicWeights c = cubic_weights(samples, value);
  MatrixXd result(table.rows(), K);
  for (Index k = 0; k < K; ++k) {
    const MatrixXd g = table.middleCols(k * n, n).transpose();
    const MatrixXd slopes = spline_slopes(samples, g);
    result.col(k) = c.value[0] * g.row(c.left) + c.value[1] * slopes.row(c.left) +
                    c.value[2] * g.row(c.right) + c.value[3] * slopes.row(c.right);
  }
  return result;
}

}  // namespace

Result<ReducedBody> settled(const ReducedBody& body, const std::map<std::string, double>& values) {
  ReducedBody result = body;
  for (const auto& [name, value] : values) {
    const auto found =
        std::find_if(result.further.begin(), result.further.end(),
                     [&name = name](const FurtherParameter& p) { return p.name == name; });
    if (found == result.further.end() || body.is_settled()) {
      std::string known;
      if (!body.is_settled()) {
        for (const FurtherParameter& p : result.further) known += " '" + p.name + "'";
      }
      return Problem{
          fmt::format("'{}' is no parameter of this body; beside site and level it has{}", name,
                      known.empty() ? " none" : known)};
    }
    const double first = found->samples[0], last = found->samples[found->samples.size() - 1];
    if (!(first <= value && value <= last)) {
      return Problem{
          fmt::format("{} = {}: the body was baked from {} to {}", name, value, first, last)};
    }
    found->value = value;
  }
  if (body.is_settled()) return result;

  const Index L = body.levels().size(), S = static_cast<Index>(body.sites.size());
  MatrixXd depth = body.further_press_depth.reshaped(L * S, body.further_press_depth.cols() / S);
  MatrixXd load = body.further_full_load;
  for (std::size_t j = result.further.size(); j-- > 0;) {
    const FurtherParameter& p = result.further[j];
    depth = at_value(depth, p.samples, p.value);
    load = at_value(load, p.samples, p.value);
    const int axis = static_cast<int>(j) + 2;
    result.displacement = result.displacement.settled(axis, p.value);
    result.stress = result.stress.settled(axis, p.value);
    if (!result.volume) continue;
    result.volume->displacement = result.volume->displacement.settled(axis, p.value);
    if (result.volume->stress)
      result.volume->stress = result.volume->stress->settled(axis, p.value);
  }
  result.press_depth = depth.reshaped(L, S);
  for (Index s = 0; s < S; ++s) {
    const auto column = result.press_depth.col(s);
    if (!(load(s, 0) > 0) || !((column.tail(L - 1) - column.head(L - 1)).minCoeff() > 0)) {
      return Problem{
          fmt::format("between its samples the loads or depths of site {} are not ordered", s)};
    }
    result.sites[s].full_load = load(s, 0);
  }
  result.further_press_depth.resize(0, 0);
  result.further_full_load.resize(0, 0);
  tabulate_press(result);
  return result;
}

void tabulate_press(ReducedBody& body) {
  const VectorXd& levels = body.levels();
  PALPABLE_EXPECT(body.press_depth.rows() == levels.size(), "a depth for each level");
  body.depth_slope = increasing_slopes(levels, body.press_depth);
  body.level_slope.resize(body.press_depth.rows(), body.press_depth.cols());
  for (Index s = 0; s < body.press_depth.cols(); ++s) {
    body.level_slope.col(s) = increasing_slopes(body.press_depth.col(s), levels);
  }
}

double level_of_press_depth(const ReducedBody& body, int site, double depth) {
  expect_table(body, site);
  if (!(depth > 0)) return body.levels()[0];
  return between(body.press_depth.col(site), body.levels(), body.level_slope.col(site), depth);
}

double press_depth_of_level(const ReducedBody& body, int site, double level) {
  expect_table(body, site);
  if (!(level > 0)) return 0;
  return between(body.levels(), body.press_depth.col(site), body.depth_slope.col(site), level);
}

void von_mises(std::span<const float> stress, std::span<float> result) {
  PALPABLE_EXPECT(stress.size() == 6 * result.size(), "six components per vertex");
  mode_kernels().front().von_mises(stress.data(), result);
}

ReducedBody scaled(const ReducedBody& body, double factor) {
  PALPABLE_EXPECT(factor > 0 && std::isfinite(factor), "a size is a number above 0");
  ReducedBody result = body;
  result.surface.vertices *= factor;
  const auto larger = [&](const SeparatedField& u) {
    return SeparatedField(u.modes() * static_cast<float>(factor), u.axes());
  };
  result.displacement = larger(body.displacement);
  result.press_depth *= factor;
  result.depth_slope *= factor;
  result.level_slope /= factor;
  result.further_press_depth *= factor;
  result.further_full_load *= factor * factor;
  if (result.volume) {
    result.volume->nodes *= factor;
    result.volume->displacement = larger(body.volume->displacement);
  }
  for (Site& site : result.sites) site.full_load *= factor * factor;
  if (result.several) {
    SeveralLoads& several = *result.several;
    // The strains are the same, and the volume is factor^3 times as large.
    for (auto* coefficients : {&several.energy.C, &several.energy.D}) {
      *coefficients *= factor * factor * factor;
    }
    several.energy.K *= factor * factor * factor;
    several.modes *= static_cast<float>(factor);
    for (Site& site : several.reactions) site.full_load *= factor * factor;
  }
  result.provenance.scaled_by = factor * body.provenance.scaled_by.value_or(1.0);
  return result;
}

}  // namespace palpable

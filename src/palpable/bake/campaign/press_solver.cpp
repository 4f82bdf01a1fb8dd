#include "palpable/bake/campaign/press_solver.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace palpable {
namespace {

using Eigen::Matrix3Xd;

bool moves_supports(const SolidModel& model) {
  const std::vector<HeldComponent> held = held_components(model);
  return std::any_of(held.begin(), held.end(),
                     [](const HeldComponent& h) { return h.displacement != 0.0; });
}

// Nothing is pressed yet: the remedy of a walk, to press less, is none.
std::string without_press(std::string why) {
  constexpr std::string_view kPress = "press less";
  const std::size_t at = why.find(kPress);
  return at == std::string::npos ? why : why.replace(at, kPress.size(), "let less act on it");
}

}  // namespace

PressSolver::PressSolver(const EquilibriumSolver& solver, const Matrix3Xd& preload, double range)
    : solver_(solver), range_(range) {
  const auto N = static_cast<Eigen::Index>(solver.model().mesh.node_count());
  PALPABLE_EXPECT(preload.cols() == 0 || preload.cols() == N, "a force for each node");
  preloaded_.rest = Matrix3Xd::Zero(3, N);
  is_preloaded_ = moves_supports(solver.model()) || (preload.cols() > 0 && !preload.isZero(0.0));
  if (!is_preloaded_) return;
  preloaded_.force = preload.cols() > 0 ? preload : preloaded_.rest;
  // Half of the preload first: the second step then starts from a linear extrapolation.
  PathResult path = solver.solve_path(preloaded_.force, std::array{0.5, 1.0});
  if (!path.complete) {
    throw PreloadError(
        fmt::format("the body cannot bear what acts on it before it is pressed (gravity, "
                    "pressures, moved supports): {}",
                    without_press(path.why_stopped)));
  }
  preloaded_.rest = std::move(path.steps.back().displacement);
}

PathResult PressSolver::solve_path(const Matrix3Xd& full_load, std::span<const double> levels,
                                   Lane* lane) const {
  return solver_.solve_path(full_load, levels, options(lane));
}

LoadSearch PressSolver::find_load(const Matrix3Xd& unit_load, double wanted_press,
                                  Lane* lane) const {
  return solver_.find_load(unit_load, wanted_press, options(lane));
}

Matrix3Xd PressSolver::linear_response(const Matrix3Xd& load, Lane* lane) const {
  return solver_.linear_response(load, options(lane));
}

PressPath PressSolver::press_path(const Matrix3Xd& unit_load, const PressGoal& goal, Lane* lane,
                                  std::function<void(double part)> tick) const {
  PathOptions with_tick = options(lane);
  with_tick.tick = std::move(tick);
  return solver_.press_path(unit_load, goal, with_tick);
}

}  // namespace palpable

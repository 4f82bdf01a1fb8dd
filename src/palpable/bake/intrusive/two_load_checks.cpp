#include "palpable/bake/intrusive/two_load_checks.h"

#include "palpable/bake/solid/equilibrium.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/cpu_time.h"
#include "palpable/common/base/error.h"
#include "palpable/common/reduced/loaded_body.h"

#include <array>
#include <cmath>
#include <random>

namespace palpable {

using Eigen::Index;
using Eigen::VectorXd;

std::vector<TwoLoadCheck> two_load_checks(const IntrusiveBake& made, int count, unsigned seed,
                                          const Progress& progress) {
  PALPABLE_EXPECT(made.body.several.has_value(), "a body that was baked for several loads");
  std::mt19937_64 random(seed);
  const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  const EquilibriumSolver newton(made.series.model());
  const VectorXd& M = made.series.mass();
  const auto norm = [&](const VectorXd& u) { return std::sqrt(u.dot(M.cwiseProduct(u))); };
  LoadedBody loaded = value_or_throw(LoadedBody::make(made.body));
  std::vector<TwoLoadCheck> checks;
  for (int k = 0; k < count; ++k) {
    const Eigen::SparseMatrix<double>&load = made.travelling.load, &back = made.travelling.reaction;
    const auto random_index = [&](Index choices) {
      return static_cast<Index>(uniform() * static_cast<double>(choices));
    };
    const Index press = random_index(load.cols()), reaction = random_index(back.cols());
    const double size = 0.05 + 0.95 * uniform(), share = uniform();
    const VectorXd f = size * (VectorXd(load.col(press)) + share * VectorXd(back.col(reaction)));
    const PathResult path =
        newton.solve_path(f.reshaped(3, f.size() / 3), std::array<double, 1>{1.0});
    if (!path.complete) throw Error("a reference was not found: " + path.why_stopped);
    const VectorXd truth = path.steps[0].displacement.reshaped();
    TwoLoadCheck check;
    (void)loaded.solve({});  // from rest
    const std::array<PlacedLoad, 2> loads{
        PlacedLoad{static_cast<int>(press), size},
        PlacedLoad{static_cast<int>(load.cols() + reaction), size * share}};
    {
      const double begin = thread_cpu_seconds();
      const LoadedBody::Answer answer = loaded.solve(loads);
      check.ms = 1e3 * (thread_cpu_seconds() - begin);
      check.steps = answer.steps;
      if (!answer.ok()) throw Error(refusal_text(made.body, answer, loads));
    }
    check.deflection = path.steps[0].displacement.colwise().norm().maxCoeff();
    check.error = norm(made.energy_modes * loaded.amplitudes() - truth) / norm(truth);
    checks.push_back(check);
    report(progress, {"two loads, solved afresh", k + 1.0, static_cast<double>(count), ""});
  }
  return checks;
}

}  // namespace palpable

// palpable-bake bench dynamics: an ear that is plucked and let go, by the full mesh in time and by
// the vibration modes of a body file; and the force of fingers that hit it, by the full mesh and
// live.

#include "apps/common/command_line.h"
#include "apps/common/progress_bar.h"
#include "palpable/bake/calculix/calculix.h"
#include "palpable/bake/describe/body_problem.h"
#include "palpable/bake/describe/touch_mesh.h"
#include "palpable/bake/pipeline/full_body.h"
#include "palpable/bake/solid/contact.h"
#include "palpable/bake/solid/implicit_dynamics.h"
#include "palpable/bake/solid/vibration_modes.h"
#include "palpable/bake/touch_bake/touch_scenes.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/order_statistics.h"
#include "palpable/common/body_file/touch_file.h"

#include <fmt/format.h>

#include "bench/bake/bench.h"
#include "bench/bake/dynamics_study.h"
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace palpable::app {
namespace {

struct BenchDynamicsOptions {
  std::string body = "bodies/bunny-demo.toml";
  std::filesystem::path baked;
  std::vector<double> plucks_mm{2, 20};
  double step_ms = 0.5;
  double rho_inf = 0.8;
  double damped_hz = 60;
  int hits = 3;
  std::uint64_t seed = 1;
  double speed = 0.2;  // m/s
  bool json = false;
};

// s: a ring that has not passed its rest often enough by then is not that of an ear.
constexpr double kLongest = 10;
constexpr int kComparedModes = 20;                   // with CalculiX
constexpr double kHitDepth = 0.005, kHitRest = 0.1;  // m; s that a thing stays
// Forces of a hit are means over this time, s: a substep of the live half.
constexpr double kHitMean = 2e-3;

// @throws Error where the file has no modes of this body
TouchableBody body_with_modes(const std::filesystem::path& file, const SkinResponse& skin) {
  TouchableBody body = value_or_throw(read_pressable_touchable_body(file));
  if (!body.touch || !body.touch->vibration) {
    throw Error(file.string() + ": has no vibration modes; bake it with a density in [material]");
  }
  if (!trouble_of(*body.touch->vibration, skin.shell_count()).empty()) {
    throw Error(file.string() + ": is not of this body");
  }
  return body;
}

// Frequencies against CalculiX on the same mesh, around the undeformed body, where every law that
// is as stiff at small strains has the same: with CalculiX' own rule for the mass, and with ours.
Json frequency_figures(const FullBody& body, double density) {
  try {
    if (body.presses.is_preloaded())
      throw Error("the body has a preload, which CalculiX is not given");
    SolidModel model = body.solver.model();
    if (!model.groups.empty()) throw Error("the body has several materials");
    const auto [lambda, mu] = lame_constants(model.material);
    model.material = SaintVenantKirchhoff{lambda, mu};
    const std::vector<double> theirs = frequencies_by_calculix(model, density, kComparedModes);
    const VibrationSettings settings{.least = kComparedModes, .below = 0};
    const LoadResponse response(model);
    const Eigen::VectorXd with_theirs =
        vibration_modes(response, calculix_mass(model.mesh, density), settings).omega;
    const Eigen::VectorXd own = vibration_modes(response, density, settings).omega;
    double error = 0, of_mass = 0;
    for (int k = 0; k < kComparedModes; ++k) {
      const double known = theirs[static_cast<std::size_t>(k)];
      error = std::max(error, std::abs(with_theirs[k] / known - 1));
      of_mass = std::max(of_mass, std::abs(own[k] / known - 1));
    }
    return {{"frequency_error", error}, {"frequency_difference_by_mass_rule", of_mass}};
  } catch (const Error& missing) {  // not installed, or not for this body
    return {{"frequency_error_missing", missing.what()}};
  }
}

Json in_unit(const std::vector<double>& values, double per_unit) {
  Json list = Json::array();
  for (const double value : values) list.push_back(per_unit * value);
  return list;
}

// What a ring is made of: modes that damp it, and the step.
struct Reference {
  const FullBody& body;
  const VibrationTable& table;
  ModalDamping damping;
  const BenchDynamicsOptions& options;
  const TouchableBody& baked;

  [[nodiscard]] ImplicitDynamics dynamics(double time_step) const {
    return ImplicitDynamics(body.solver.model(), table.density, damping,
                            {.time_step = time_step, .rho_inf = options.rho_inf},
                            body.presses.preloaded());
  }
  [[nodiscard]] FullRing ring(const PluckedPlace& place, const Eigen::Matrix3Xd& start,
                              double time_step) const {
    ImplicitDynamics dynamics = this->dynamics(time_step);
    return ring_in_full(dynamics, body.skin, place, start, time_step, kComparedCrossings, kLongest);
  }
};

Json pluck_figures(const Reference& reference, const PluckedPlace& place, double press,
                   ProgressBar& bar) {
  const auto& [body, table, damping, options, baked] = reference;
  const double h = 1e-3 * options.step_ms;
  bar.show({"pulls, lets go", 0, 3, fmt::format("{:g} mm", 1e3 * press)});
  const LoadSearch pull = body.solver.find_load(unit_pull(body.skin, place), press,
                                                {.preloaded = body.presses.preloaded()});
  if (!pull.reached) return {{"stopped", pull.why_stopped}};
  const auto begin = std::chrono::steady_clock::now();
  bar.show(
      {"pulls, lets go", 1, 3, fmt::format("{:g} mm, steps of {:g} ms", 1e3 * press, 1e3 * h)});
  const FullRing full = reference.ring(place, pull.state.displacement, h);
  const double seconds = seconds_since(begin);
  bar.show(
      {"pulls, lets go", 2, 3, fmt::format("{:g} mm, steps of {:g} ms", 1e3 * press, 2e3 * h)});
  const FullRing coarse = reference.ring(place, pull.state.displacement, 2 * h);
  const Ring modes = ring_of_modes(table, place, pull.load, h,
                                   static_cast<int>(1.5 * static_cast<double>(full.steps)));
  const RingDifference difference = ring_difference(modes, full.ring);
  // The full ring with half as many samples, to compare it with the coarse one.
  Ring half{2 * h, {}};
  for (std::size_t n = 0; n < full.ring.motion.size(); n += 2) {
    half.motion.push_back(full.ring.motion[n]);
  }
  // Both end with the sixth crossing; a sample more on the other side keeps it in the halved one.
  if (full.ring.motion.size() % 2 == 0) {
    half.motion.push_back(2 * full.ring.motion.back() -
                          full.ring.motion[full.ring.motion.size() - 2]);
  }
  const RingDifference of_step = ring_difference(coarse.ring, half);
  return {{"load_n", pull.load},
          {"modes_share_of_pull", modes.motion.front() / press},
          {"ring_amplitude_error", difference.amplitude},
          {"ring_phase_error", std::abs(difference.phase)},
          {"ring_trace_error", difference.trace},
          {"amplitude_errors", difference.amplitudes},
          {"phase", difference.phase},
          {"period_ms", 1e3 * difference.period},
          {"zero_crossings_ms", in_unit(zero_crossings(full.ring), 1e3)},
          {"zero_crossings_of_modes_ms", in_unit(zero_crossings(modes), 1e3)},
          {"swings_mm", in_unit(swings(full.ring), 1e3)},
          {"twice_the_step_amplitude", of_step.amplitude},
          {"twice_the_step_phase", of_step.phase},
          {"energy_growth", full.energy_rise / full.energy},
          {"energy_balance_error", full.balance_error / full.energy},
          {"energy_j", full.energy},
          {"steps", full.steps},
          {"newton_steps", full.newton_steps},
          {"cg_iterations", full.cg_iterations},
          {"full_s", seconds}};
}

// The force of a finger that comes at a speed and stays: the truth for the live half's.
Json hit_figures(const Reference& reference, const TouchScene& scene) {
  const BenchDynamicsOptions& options = reference.options;
  const Hit hit{scene, options.speed, kHitDepth};
  const double seconds = hit.depth / hit.speed + kHitRest;
  try {
    const auto forces_with = [&](double time_step) {
      ImplicitDynamics dynamics = reference.dynamics(time_step);
      return means_of_groups(hit_in_full(dynamics, hit, reference.baked.touch->point_spacing,
                                         static_cast<int>(seconds / time_step)),
                             std::max(1, static_cast<int>(std::lround(kHitMean / time_step))));
    };
    const double h = 1e-3 * options.step_ms;
    const std::vector<Eigen::Vector3d> forces = forces_with(h), coarse = forces_with(2 * h);
    ContactWalk walk(
        reference.body.solver, [&](double t) { return obstacle_at(scene, t * hit.depth); }, 0.0,
        {.spacing = reference.baked.touch->point_spacing}, reference.body.presses.preloaded());
    if (!walk.advance(1.0)) return {{"stopped", walk.why_stopped()}};
    std::vector<double> sizes;
    for (const Eigen::Vector3d& force : forces) sizes.push_back(force.norm());
    const double at_rest = walk.now().force.norm(), peak = peak_of(forces);
    const std::vector<Eigen::Vector3d> live =
        hit_live(reference.baked, hit, kHitMean, static_cast<int>(forces.size()));
    std::vector<double> live_sizes;
    for (const Eigen::Vector3d& force : live) live_sizes.push_back(force.norm());
    return {{"at_rest_n", at_rest},
            {"peak_n", peak},
            {"peak_over_rest", peak / at_rest},
            {"last_over_rest", forces.back().norm() / at_rest},
            {"twice_the_step_peak", std::abs(peak_of(coarse) / peak - 1)},
            {"hit_force_error", std::abs(peak_of(live) / peak - 1)},
            {"trace_error", difference_of(live, forces)},
            {"live_n", live_sizes},
            {"forces_n", sizes}};
  } catch (const Error& error) { return {{"stopped", error.what()}}; }
}

void bench_dynamics(const BenchDynamicsOptions& options) {
  ProgressBar bar;
  const BodyProblem problem = pose_for_touch(read_body_description(options.body));
  const FullBody body(problem.model, problem.mesh.boundary, problem.preload);
  const TouchableBody baked = body_with_modes(options.baked, body.skin);
  const VibrationTable& table = *baked.touch->vibration;
  bar.show({"vibration modes", 0, 1, {}});
  const VibrationModes modes = vibration_modes(
      body.skin.body(), table.density,
      {.least = table.mode_count(), .below = 2 * std::numbers::pi * options.damped_hz});
  const PluckedPlace place = softest_place(body.skin, table);
  const Reference reference{
      body, table, {modes.omega, modes.shapes, table.damping()}, options, baked};
  bar.show({"CalculiX' frequencies", 0, 1, {}});
  Json figures = frequency_figures(body, table.density);
  figures["eigen_residual"] = modes.residual.maxCoeff();
  figures["nodes"] = problem.model.mesh.node_count();
  figures["modes"] = table.mode_count();
  figures["lowest_hz"] = table.omega.front() / (2 * std::numbers::pi);
  figures["highest_hz"] = table.omega.back() / (2 * std::numbers::pi);
  figures["damped_modes"] = modes.omega.size();
  figures["damping_ratio"] = table.damping();
  figures["time_step_ms"] = options.step_ms;
  figures["rho_inf"] = options.rho_inf;
  figures["vertex"] = place.vertex;
  const Eigen::Vector3d at = 1e3 * body.skin.skin().vertices.col(place.vertex);
  figures["place_mm"] = {at[0], at[1], at[2]};
  figures["direction"] = {place.direction[0], place.direction[1], place.direction[2]};
  for (std::size_t k = 0; k < options.plucks_mm.size(); ++k) {
    const Json pluck = pluck_figures(reference, place, 1e-3 * options.plucks_mm[k], bar);
    // The figures with bars are of the first one.
    for (const char* name : {"ring_amplitude_error", "ring_phase_error", "energy_growth"}) {
      if (k == 0 && pluck.contains(name)) figures[name] = pluck[name];
    }
    figures[fmt::format("pluck_{:g}mm", options.plucks_mm[k])] = pluck;
  }
  Json hits = Json::array();
  for (const TouchScene& scene :
       touch_scenes(body.skin, PressingThing::kFinger, options.hits, options.seed)) {
    bar.show({"is hit", static_cast<double>(hits.size()), static_cast<double>(options.hits), {}});
    hits.push_back(hit_figures(reference, scene));
  }
  std::vector<double> errors;
  for (const Json& hit : hits) {
    if (hit.contains("hit_force_error")) errors.push_back(hit["hit_force_error"].get<double>());
  }
  if (!errors.empty()) figures["hit_force_error"] = percentile(errors, 0.5);
  figures["hits"] = hits;
  figures["hit_speed"] = options.speed;
  figures["hit_depth_mm"] = 1e3 * kHitDepth;
  figures["hit_mean_ms"] = 1e3 * kHitMean;
  figures["seed"] = options.seed;
  bar.finish();
  print_figures(figures, options.json);
}

}  // namespace

void add_bench_dynamics(Command bench) {
  const auto options = std::make_shared<BenchDynamicsOptions>();
  Command command = bench.add_subcommand(
      "dynamics",
      "An ear that is plucked, fingers that hit: the full mesh in time, and the live half "
      "(minutes)");
  command.add_option("body", options->body, "The body that is plucked")
      .type_name("FILE.toml")
      .show_default();
  command.add_option("--baked", options->baked, "The body file that was baked from it")
      .type_name("FILE.palpable")
      .required();
  command
      .add_option("--plucks", options->plucks_mm,
                  "mm, how far it is pulled; the figures at the top are those of the first")
      .show_default();
  command.add_option("--step", options->step_ms, "ms, of the full mesh; twice that is solved too")
      .in_range(0.01, 10.0)
      .show_default();
  command.add_option("--rho-inf", options->rho_inf, "Of the generalised-alpha method")
      .in_range(0.0, 1.0)
      .show_default();
  command
      .add_option("--damped-below", options->damped_hz,
                  "Hz: all modes below it have the damping ratio of the material in the full mesh")
      .in_range(0.0, 1000.0)
      .show_default();
  command.add_option("--hits", options->hits, "Fingers that hit it at random places, 5 mm deep")
      .in_range(0, 100)
      .show_default();
  command.add_option("--seed", options->seed, "Of the places").show_default();
  command.add_option("--speed", options->speed, "m/s, of the fingers")
      .in_range(0.001, 5.0)
      .show_default();
  command.add_json(options->json);
  command.footer(
      "The ear is in equilibrium under a force at its tip, which is gone at the time 0. Of a hit "
      "the largest mean force over 2 ms is compared; hit_force_error is the median over the "
      "hits.\n"
      "Example: palpable bench dynamics bodies/bunny-demo.toml --baked bunny.palpable --json");
  command.callback([options] { bench_dynamics(*options); });
}

}  // namespace palpable::app

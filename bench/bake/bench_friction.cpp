// palpable-bake bench friction: friction of the full solver against known solutions, and its
// effect, which the tables of touch ignore.

#include "apps/common/command_line.h"
#include "apps/common/progress_bar.h"
#include "palpable/bake/describe/body_problem.h"
#include "palpable/bake/pipeline/full_body.h"
#include "palpable/bake/solid/friction_cases.h"
#include "palpable/bake/touch_bake/touch_maker.h"
#include "palpable/bake/touch_bake/touch_scenes.h"
#include "palpable/bake/truth/hand_walks.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/order_statistics.h"

#include <fmt/format.h>

#include "bench/bake/bench.h"
#include "bench/bake/contact_comparison.h"
#include "bench/bake/friction_study.h"
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace palpable::app {
namespace {

struct BenchFrictionOptions {
  std::string body = "bodies/bunny-demo.toml";
  int each = 2;
  double coefficient = 0.3;
  std::uint64_t seed = 0;  // 0: random
  int cells = 12;          // in a radius of the contact of Cattaneo and Mindlin
  int squeezes = 8;
  bool known_alone = false;
  bool json = false;
};

// Without the squeeze, which is not dragged aside.
constexpr std::array kThings{PressingThing::kFinger, PressingThing::kPencil, PressingThing::kPalm,
                             PressingThing::kHand, PressingThing::kRim};

std::string moment_of(const FrictionDifference& d) {
  return d.dragged > 0 ? fmt::format("dragged_{:g}mm", 1e3 * d.dragged)
                       : fmt::format("at_{:g}mm", 1e3 * d.depth);
}

// Name and unit of the differences in the output.
struct ReportedDifference {
  const char* name;
  double FrictionDifference::*value;
  double per_unit;
};
constexpr std::array kReported{
    ReportedDifference{"u_median", &FrictionDifference::displacement, 1},
    ReportedDifference{"worst_vertex_median_mm", &FrictionDifference::worst_vertex, 1e3},
    ReportedDifference{"force_median", &FrictionDifference::force, 1},
    ReportedDifference{"angle_median_deg", &FrictionDifference::angle, 180 / std::numbers::pi},
    ReportedDifference{"vm_median", &FrictionDifference::von_mises, 1},
    ReportedDifference{"half_step_median", &FrictionDifference::half_step, 1}};

// Medians of the differences for each thing and moment.
Json medians_of(const std::vector<FrictionDifference>& all) {
  std::map<std::pair<std::string, std::string>, std::vector<FrictionDifference>> groups;
  for (const FrictionDifference& d : all) groups[{name_of(d.thing), moment_of(d)}].push_back(d);
  Json figures = Json::object();
  for (const auto& [group, differences] : groups) {
    Json& entry = figures[group.first][group.second];
    entry["scenes"] = differences.size();
    for (const ReportedDifference& reported : kReported) {
      std::vector<double> values;
      for (const FrictionDifference& d : differences) values.push_back(d.*reported.value);
      entry[reported.name] = reported.per_unit * percentile(values, 0.5);
    }
  }
  return figures;
}

// Friction against solutions that are known. Those that are not found are named.
Json known_figures(const BenchFrictionOptions& options, ProgressBar& bar) {
  constexpr double kCoefficient = 0.3;
  constexpr int kFrames = 600;  // 20 s at 30 frames a second
  Json figures = Json::object(), stopped = Json::array();
  int number = 0;
  const auto add = [&](const char* name, const std::function<Json()>& find) {
    bar.show({"known solutions", static_cast<double>(number++), 4, name});
    try {
      figures.update(find());
    } catch (const Error& error) { stopped.push_back(error.what()); }
  };
  add("plate", [] {
    const SlipResult slip = pull_plate(6, kCoefficient, 40);
    return Json{{"slip_angle_error", std::abs(slip.angle_error)},
                {"slip_largest_ratio", slip.largest_ratio},
                {"slip_least_ratio_while_sliding", slip.least_sliding},
                {"slip_energy_error", slip.energy_error},
                {"slip_least_lost", slip.least_lost}};
  });
  add("rest", [] {
    Json rest = Json::object();
    rest["creep_mm"] = 1e3 * creep_at_rest(6, kCoefficient, kFrames);
    return rest;
  });
  add("capstan", [] {
    const CapstanResult capstan = slide_strip(80, kCoefficient);
    return Json{{"capstan_error", std::abs(capstan.error)},
                {"capstan_ratio", capstan.ratio},
                {"capstan_angle_deg", capstan.angle * 180 / std::numbers::pi},
                {"capstan_sticking", capstan.sticking}};
  });
  add("Cattaneo and Mindlin", [&options] {
    const MindlinResult mindlin = drag_mindlin_block(options.cells);
    return Json{{"cattaneo_stick_radius_error", mindlin.stick_radius_error},
                {"tangential_displacement_error", mindlin.displacement_error},
                {"unloading_displacement_error", mindlin.unloading_error},
                {"cattaneo_cells_in_radius", options.cells},
                {"cattaneo_nodes", mindlin.nodes},
                {"cattaneo_compliance_error", mindlin.compliance_error},
                {"cattaneo_elastic_slip", mindlin.elastic_slip},
                {"cattaneo_cone_error", mindlin.cone_error}};
  });
  figures["known_stopped"] = stopped;
  return figures;
}

// Friction against CalculiX' own, on one mesh.
Json calculix_friction(const BenchFrictionOptions& options, ProgressBar& bar) {
  bar.show({"CalculiX' friction", 0, 1, ""});
  try {
    const std::vector<ContactDifference> found = compare_contact(6, {10, 100}, options.coefficient);
    return {{"ccx_friction_difference_u", found.back().displacement},
            {"ccx_friction_difference_force", found.back().force},
            {"ccx_friction_soft_difference_u", found.front().displacement}};
  } catch (const Error& error) {  // not installed, or without a solution
    Json figures = Json::object();
    figures["ccx_friction_stopped"] = error.what();
    return figures;
  }
}

// How many squeezes have two solutions: that with half the step is another one.
Json squeeze_figures(const FullBody& body, const BenchFrictionOptions& options, std::uint64_t seed,
                     ProgressBar& bar) {
  int with = 0, without = 0, solved = 0, number = 0;
  const std::vector<TouchScene> scenes =
      touch_scenes(body.skin, PressingThing::kSqueeze, options.squeezes, seed);
  for (const TouchScene& scene : scenes) {
    bar.show({"squeezes, with and without friction", static_cast<double>(number++),
              static_cast<double>(scenes.size()), ""});
    const auto change = [&](double coefficient) {
      return change_of_press(body.solver, body.skin, body.presses.preloaded(),
                             TouchBakeSettings().point_spacing, scene, coefficient);
    };
    const std::optional<double> rubs = change(options.coefficient), slides = change(0.0);
    if (!rubs || !slides) continue;
    ++solved;
    if (*rubs > kPathMatters) ++with;
    if (*slides > kPathMatters) ++without;
  }
  return {{"squeezes", solved},
          {"squeezes_path_dependent", with},
          {"squeezes_path_dependent_without_friction", without}};
}

void bench_friction(const BenchFrictionOptions& options) {
  ProgressBar bar;
  Json known = known_figures(options, bar);
  known.update(calculix_friction(options, bar));
  if (options.known_alone) {
    bar.finish();
    print_figures(known, options.json);
    return;
  }
  const BodyProblem problem = pose_body(read_body_description(options.body));
  const FullBody body(problem.model, problem.mesh.boundary, problem.preload);
  const std::uint64_t seed = options.seed > 0 ? options.seed : std::random_device()();
  std::vector<FrictionDifference> all;
  Json stopped = Json::array();
  int number = 0;
  for (const PressingThing thing : kThings) {
    for (const TouchScene& scene : touch_scenes(body.skin, thing, options.each, seed)) {
      bar.show({"with and without friction", static_cast<double>(number++),
                static_cast<double>(kThings.size()) * options.each, name_of(thing)});
      const std::string why = compare_friction(
          body.solver, body.skin, body.presses.preloaded(), TouchBakeSettings().point_spacing,
          scene, options.coefficient, [&all](const FrictionDifference& d) { all.push_back(d); });
      if (!why.empty()) stopped.push_back(fmt::format("{}: {}", name_of(thing), why));
    }
  }
  const Json squeezes = squeeze_figures(body, options, seed, bar);
  bar.finish();
  Json figures = medians_of(all);
  figures.update(known);
  figures.update(squeezes);
  std::vector<double> half_steps;
  for (const FrictionDifference& d : all) half_steps.push_back(d.half_step);
  if (!half_steps.empty()) figures["step_halving"] = percentile(half_steps, 0.5);
  figures["seed"] = seed;
  figures["coefficient"] = options.coefficient;
  figures["stopped"] = stopped;
  print_figures(figures, options.json);
}

}  // namespace

void add_bench_friction(Command bench) {
  const auto options = std::make_shared<BenchFrictionOptions>();
  Command command = bench.add_subcommand(
      "friction",
      "Friction of the full solver against known solutions, and what it changes (minutes)");
  command.add_option("body", options->body, "The body that is touched")
      .type_name("FILE.toml")
      .show_default();
  command.add_option("--each", options->each, "Scenes of each thing")
      .in_range(1, 1000)
      .show_default();
  command.add_option("--coefficient", options->coefficient, "Coulomb's, between thing and skin")
      .in_range(0.01, 10.0)
      .show_default();
  command.add_option("--seed", options->seed, "Of the scenes; 0: a fresh one, which is printed")
      .show_default();
  command
      .add_option("--cells", options->cells,
                  "Cells of the mesh in the contact radius, for Cattaneo and Mindlin")
      .in_range(4, 24)
      .show_default();
  command.add_option("--squeezes", options->squeezes, "Scenes of finger and thumb")
      .in_range(1, 1000)
      .show_default();
  command.add_flag("--known", options->known_alone, "The known solutions alone");
  command.add_json(options->json);
  command.footer(
      "Things press the body by 5 mm and are then dragged aside by 5 mm. The tables of touch "
      "ignore\n"
      "friction: this measures the error that it causes.\n"
      "Example: palpable bench friction bodies/bunny-demo.toml --coefficient 0.5");
  command.callback([options] { bench_friction(*options); });
}

}  // namespace palpable::app

// palpable-bake bench friction: the effect of friction, which the tables of touch ignore.

#include "apps/common/command_line.h"
#include "apps/common/progress_bar.h"
#include "palpable/bake/describe/body_problem.h"
#include "palpable/bake/pipeline/full_body.h"
#include "palpable/bake/touch_bake/touch_maker.h"
#include "palpable/bake/touch_bake/touch_scenes.h"
#include "palpable/common/base/order_statistics.h"

#include <fmt/format.h>

#include "bench/bake/bench.h"
#include "bench/bake/friction_study.h"
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <numbers>
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
    ReportedDifference{"vm_median", &FrictionDifference::von_mises, 1}};

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

void bench_friction(const BenchFrictionOptions& options) {
  ProgressBar bar;
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
  bar.finish();
  Json figures = medians_of(all);
  figures["seed"] = seed;
  figures["coefficient"] = options.coefficient;
  figures["stopped"] = stopped;
  print_figures(figures, options.json);
}

}  // namespace

void add_bench_friction(Command bench) {
  const auto options = std::make_shared<BenchFrictionOptions>();
  Command command = bench.add_subcommand(
      "friction", "What friction changes, by full finite elements with and without it (minutes)");
  command.add_option("body", options->body, "The body that is touched")
      .type_name("FILE.toml")
      .show_default();
  command.add_option("--each", options->each, "Scenes of each thing")
      .in_range(1, 1000)
      .show_default();
  command.add_option("--coefficient", options->coefficient, "Coulomb's, between thing and skin")
      .in_range(0.01, 10.0)
      .show_default();
  command.add_option("--seed", options->seed, "Of the scenes; 0: a fresh one, which is printed");
  command.add_json(options->json);
  command.footer(
      "Things press the body by 5 mm and are then dragged aside by 5 mm. The tables of touch "
      "ignore\n"
      "friction: this measures the error that it causes.\n"
      "Example: palpable bench friction bodies/bunny-demo.toml --coefficient 0.5");
  command.callback([options] { bench_friction(*options); });
}

}  // namespace palpable::app

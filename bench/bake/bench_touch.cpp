// palpable-bake bench touch: compares the response of a body's tables with full-order solutions.

#include "apps/common/command_line.h"
#include "apps/common/progress_bar.h"
#include "palpable/bake/describe/body_problem.h"
#include "palpable/bake/describe/touch_mesh.h"
#include "palpable/bake/pipeline/full_body.h"
#include "palpable/bake/touch_bake/held_out_maker.h"
#include "palpable/bake/touch_bake/touch_difference.h"
#include "palpable/bake/touch_bake/touch_maker.h"
#include "palpable/bake/touch_bake/touch_scenes.h"
#include "palpable/bake/truth/hand_walks.h"
#include "palpable/common/base/cpu_time.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/order_statistics.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/body_file/touch_file.h"
#include "palpable/live/render/gl_context.h"
#include "palpable/live/render/picture_file.h"

#include <fmt/core.h>
#include <fmt/format.h>

#include "bench/bake/bench.h"
#include "bench/bake/touch_pictures.h"
#include "bench/bake/touch_study.h"
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace palpable::app {
namespace {

struct BenchTouchOptions {
  std::string body = "bodies/bunny-demo.toml";
  int each = 4;
  std::uint64_t seed = 0;  // 0: random
  int refine = 0;
  std::filesystem::path baked;  // empty: the tables are made
  bool linear = false;
  std::optional<double> friction;  // Coulomb's coefficient; none: that of the body
  std::filesystem::path pictures;  // folder; empty: no pictures
  bool json = false;
};

constexpr std::array kDepths{0.0025, 0.005, 0.010};  // m
constexpr double kDragDepth = 0.005;                 // m, of things that are then dragged aside
constexpr std::array kDrags{0.0025, 0.005};          // m
constexpr int kLinearLoads = 100;                    // for the error of the compliance table

// Whether the full-order solution is another one with half the steps: then there is no truth that
// the tables could be compared with.
bool is_path_dependent(const TouchDifference& d) {
  return d.half_step && *d.half_step > kPathMatters;
}

// Median and p90 of differences; only the count without any.
Json summary_of(const std::vector<TouchDifference>& some) {
  if (some.empty()) return Json{{"scenes", 0}};
  std::vector<double> u, force, stress, worst, entry, cone;
  for (const TouchDifference& d : some) {
    u.push_back(d.touch.displacement);
    force.push_back(d.touch.force);
    stress.push_back(d.touch.von_mises);
    worst.push_back(1e3 * d.worst_vertex);
    entry.push_back(1e3 * d.report.penetration);
    cone.push_back(1e3 * d.report.friction_residual);
  }
  Json summary{{"scenes", u.size()},
               {"u_median", percentile(u, 0.5)},
               {"u_p90", percentile(u, 0.9)},
               {"force_median", percentile(force, 0.5)},
               {"force_p90", percentile(force, 0.9)},
               {"vm_median", percentile(stress, 0.5)},
               {"vm_p90", percentile(stress, 0.9)},
               {"worst_vertex_median_mm", percentile(worst, 0.5)},
               {"penetration_median_mm", percentile(entry, 0.5)}};
  if (*std::max_element(cone.begin(), cone.end()) > 0) {
    summary["friction_residual_p90_mm"] = percentile(cone, 0.9);
  }
  return summary;
}

// The summary of those that do not depend on the path, and the share of those that do, where that
// was judged.
Json summary_without_path_dependent(const std::vector<TouchDifference>& all) {
  std::vector<TouchDifference> some;
  for (const TouchDifference& d : all) {
    if (!is_path_dependent(d)) some.push_back(d);
  }
  Json summary = summary_of(some);
  if (all.front().half_step) {
    summary["path_dependent_share"] =
        static_cast<double>(all.size() - some.size()) / static_cast<double>(all.size());
  }
  return summary;
}

// The differences for each thing, depth and drag, after `refined` full-order solutions were
// adopted.
Json differences_of(const std::vector<TouchDifference>& all, int refined) {
  Json figures = Json::object();
  for (int k = 0; k < kPressingThings; ++k) {
    const auto thing = static_cast<PressingThing>(k);
    const auto add = [&](const std::string& key, double depth, double dragged) {
      std::vector<TouchDifference> some;
      for (const TouchDifference& d : all) {
        if (d.touch.thing == thing && d.touch.depth == depth && d.dragged == dragged &&
            d.refined == refined) {
          some.push_back(d);
        }
      }
      if (!some.empty()) figures[name_of(thing)][key] = summary_without_path_dependent(some);
    };
    for (const double depth : kDepths) add(fmt::format("at_{:g}mm", 1e3 * depth), depth, 0);
    for (const double drag : kDrags) {
      add(fmt::format("dragged_{:g}mm", 1e3 * drag), kDragDepth, drag);
    }
  }
  return figures;
}

Json scenes_of(const std::vector<TouchDifference>& all) {
  Json scenes = Json::array();
  for (const TouchDifference& d : all) {
    scenes.push_back({{"thing", name_of(d.touch.thing)},
                      {"depth_mm", 1e3 * d.touch.depth},
                      {"dragged_mm", 1e3 * d.dragged},
                      {"refined", d.refined},
                      {"half_step", d.half_step ? Json(*d.half_step) : Json()},
                      {"u", d.touch.displacement},
                      {"force", d.touch.force},
                      {"vm", d.touch.von_mises},
                      {"last_share", d.report.last_share},
                      {"stated", d.report.stated ? Json(d.report.stated->displacement) : Json()},
                      {"entry", d.report.indicators.entry},
                      {"beyond", d.report.indicators.beyond},
                      {"cross", d.report.indicators.cross},
                      {"candidates", d.report.candidates},
                      {"patches", d.report.patches},
                      {"ms", d.milliseconds}});
  }
  return scenes;
}

// Ratio of the stated error to the true one. Intended: a median of 0.7 to 1.4, and less than 0.5
// for at most 5 % of the touches.
Json stated_over_true(const std::vector<TouchDifference>& all, int refined,
                      std::optional<PressingThing> thing, double deepest,
                      double StatedError::*stated, double HeldOutTouch::*truth) {
  std::vector<double> ratios;
  for (const TouchDifference& d : all) {
    if ((thing && d.touch.thing != *thing) || d.touch.depth > deepest || d.dragged > 0) continue;
    if (d.refined != refined || is_path_dependent(d)) continue;
    if (d.report.stated) ratios.push_back((*d.report.stated).*stated / d.touch.*truth);
  }
  if (ratios.empty()) return nullptr;
  const auto low = std::count_if(ratios.begin(), ratios.end(), [](double r) { return r < 0.5; });
  return {{"touches", ratios.size()},
          {"median", percentile(ratios, 0.5)},
          {"p90", percentile(ratios, 0.9)},
          {"below_half", static_cast<double>(low) / static_cast<double>(ratios.size())}};
}

Json stated_errors_of(const std::vector<TouchDifference>& all, int refined) {
  const auto displacement = [&](std::optional<PressingThing> thing, double deepest) {
    return stated_over_true(all, refined, thing, deepest, &StatedError::displacement,
                            &HeldOutTouch::displacement);
  };
  Json result = displacement({}, kDepths.back());
  if (result.is_null()) return result;
  result["to_5mm"] = displacement({}, kDepths[1]);
  result["stress"] = stated_over_true(all, refined, {}, kDepths.back(), &StatedError::von_mises,
                                      &HeldOutTouch::von_mises);
  for (int k = 0; k < kPressingThings; ++k) {
    const auto thing = static_cast<PressingThing>(k);
    result[name_of(thing)] = displacement(thing, kDepths.back());
  }
  return result;
}

// Writes one picture for each scene and depth.
class Pictures {
 public:
  Pictures(const std::filesystem::path& folder, const SurfaceMesh& skin)
      : folder_(folder), context_(value_or_throw(GlContext::offscreen())), pictures_(skin) {
    make_folder(folder);
  }

  void write(const TouchScene& scene, int number, const TouchDifference& difference) {
    write_png(folder_ / fmt::format("{}_{}_{:g}mm.png", name_of(scene.thing), number,
                                    1e3 * difference.touch.depth),
              pictures_.draw(scene, difference));
  }

 private:
  std::filesystem::path folder_;
  GlContext context_;
  TouchPictures pictures_;
};

// Reads the tables of a baked body; of an embedded skin, those of the coarse body in
// which it is embedded.
TouchTables tables_in(const std::filesystem::path& file, const SkinResponse& skin) {
  TouchableBody body = value_or_throw(read_pressable_touchable_body(file));
  const auto are_of_skin = [&] {
    if (!body.touch || body.touch->compliance.nodes() != skin.shell_count()) return false;
    const SurfaceMesh& known = body.touch->coarse ? body.touch->coarse->surface : body.body.surface;
    return known.vertex_count() == skin.vertex_count() &&
           known.vertices.isApprox(skin.skin().vertices, 1e-5);
  };
  if (!are_of_skin()) throw Error(file.string() + ": has no tables of touch of this body");
  TouchTables tables = std::move(*body.touch);
  tables.coarse = std::nullopt;
  return tables;
}

// Makes the tables of a body with held-out touches, and measures the time without these.
// @pre options.friction
std::pair<TouchTables, double> made_tables(const FullBody& body, const BenchTouchOptions& options,
                                           const Progress& progress) {
  TouchBakeSettings settings;
  settings.threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  settings.friction = *options.friction;
  if (options.linear) settings.regions.most = 0;
  const auto begin = std::chrono::steady_clock::now();
  TouchTables made = make_touch_tables(body.skin, settings, progress);
  const double seconds = seconds_since(begin);
  // The held-out touches calibrate the stated error; they have another seed than this benchmark.
  made.held_out = make_held_out(body.solver, body.skin, body.presses.preloaded(), made,
                                {.threads = settings.threads}, progress);
  return {std::move(made), seconds};
}

// The touches of all scenes, and why full-order solutions stopped early.
struct ComparedScenes {
  std::vector<TouchDifference> all;
  Json stopped = Json::array();
};

// @pre options.friction
ComparedScenes compare_scenes(const FullBody& body, const TouchTables& tables, TouchSolver& touch,
                              const BenchTouchOptions& options, std::uint64_t seed,
                              ProgressBar& bar) {
  std::optional<Pictures> pictures;
  if (!options.pictures.empty()) pictures.emplace(options.pictures, body.skin.skin());
  ComparedScenes scenes;
  const double friction = *options.friction;
  for (int k = 0; k < kPressingThings; ++k) {
    const auto thing = static_cast<PressingThing>(k);
    int number = 0;
    for (const TouchScene& scene : touch_scenes(body.skin, thing, options.each, seed)) {
      bar.show({"full-order solutions, scene by scene",
                static_cast<double>(k * options.each + number++),
                static_cast<double>(kPressingThings * options.each), name_of(thing)});
      const std::string why =
          compare_touch(body.solver, body.skin, body.presses.preloaded(), touch,
                        tables.point_spacing, scene, kDepths,
                        [&](const TouchDifference& d) {
                          scenes.all.push_back(d);
                          if (pictures && d.refined == 0) pictures->write(scene, number, d);
                        },
                        {.friction = friction,
                         .refinements = options.refine,
                         .halves_steps = friction > 0 && thing == PressingThing::kSqueeze});
      if (!why.empty()) scenes.stopped.push_back(fmt::format("{}: {}", name_of(thing), why));
      if (!(friction > 0) || thing == PressingThing::kSqueeze) continue;
      const std::string stopped = compare_drag(
          body.solver, body.skin, body.presses.preloaded(), touch, tables.point_spacing, scene,
          kDragDepth, kDrags, [&](const TouchDifference& d) { scenes.all.push_back(d); },
          {.friction = friction});
      if (!stopped.empty()) {
        scenes.stopped.push_back(fmt::format("{}, dragged: {}", name_of(thing), stopped));
      }
    }
  }
  return scenes;
}

// The differences and the stated errors, also after each refinement.
Json errors_of(const std::vector<TouchDifference>& all, int refine) {
  Json figures = differences_of(all, 0);
  for (int k = 1; k <= refine; ++k) {
    Json& refined = figures[fmt::format("refined_{}", k)];
    refined = differences_of(all, k);
    refined["stated_over_true_error"] = stated_errors_of(all, k);
  }
  figures["stated_over_true_error"] = stated_errors_of(all, 0);
  return figures;
}

Json sizes_of(const TouchTables& tables) {
  return {{"regions", tables.regions.size()},
          {"table_mb", static_cast<double>(bytes_of(tables)) / 1e6},
          {"table_mb_without_stress",
           static_cast<double>(bytes_of(tables) - stress_bytes_of(tables)) / 1e6},
          {"shell_nodes", tables.shell.nodes()},
          {"shell_elements", tables.shell.element_count()}};
}

Json times_of(const std::vector<TouchDifference>& all) {
  std::vector<double> ms, stress_ms;
  for (const TouchDifference& d : all) {
    if (d.refined > 0) continue;
    ms.push_back(d.milliseconds);
    stress_ms.push_back(d.stress_milliseconds);
  }
  return {{"ms_median", percentile(ms, 0.5)},
          {"ms_p99", percentile(ms, 0.99)},
          {"stress_ms_median", percentile(stress_ms, 0.5)},
          {"stress_ms_p99", percentile(stress_ms, 0.99)}};
}

void bench_touch(BenchTouchOptions options) {
  ProgressBar bar;
  const BodyDescription description = read_body_description(options.body);
  const BodyProblem problem = pose_for_touch(description);
  const FullBody body(problem.model, problem.mesh.boundary, problem.preload);
  const SkinResponse& skin = body.skin;
  std::optional<TouchTables> baked;
  if (!options.baked.empty()) baked = tables_in(options.baked, skin);
  if (!options.friction) options.friction = baked ? baked->friction : description.touch.friction;
  const auto [tables, bake_s] =
      baked ? std::pair(std::move(*baked), 0.0) : made_tables(body, options, bar.progress());
  TouchSolver touch(skin.skin(), skin.fixed(), tables, {.friction = options.friction});
  const std::uint64_t seed = options.seed > 0 ? options.seed : std::random_device()();
  const ComparedScenes scenes = compare_scenes(body, tables, touch, options, seed, bar);
  Json figures = errors_of(scenes.all, options.refine);
  figures["seed"] = seed;
  figures["friction"] = *options.friction;
  // The stated error is measured with this one, which in a body file may be another.
  figures["held_out_friction"] = tables.friction;
  figures["vertices"] = skin.vertex_count();
  figures["nodes"] = problem.model.mesh.node_count();
  figures.update(sizes_of(tables));
  if (options.baked.empty()) figures["bake_s"] = bake_s;
  const std::vector<double> linear =
      compliance_errors(skin, Compliance(tables.compliance), kLinearLoads, seed);
  figures["compliance_error_median"] = percentile(linear, 0.5);
  figures["compliance_error_worst"] = percentile(linear, 1.0);
  figures["truth_stopped"] = scenes.stopped;
  figures.update(times_of(scenes.all));
  figures["largest_slide_jump_mm"] = 1e3 * largest_slide_jump(skin, touch, seed);
  if (options.json) figures["scenes"] = scenes_of(scenes.all);
  bar.finish();
  print_figures(figures, options.json);
}

}  // namespace

void add_bench_touch(Command bench) {
  const auto options = std::make_shared<BenchTouchOptions>();
  Command command = bench.add_subcommand(
      "touch", "Touch by anything, anywhere, against full finite elements (minutes to an hour)");
  command.add_option("body", options->body, "The body that is touched")
      .type_name("FILE.toml")
      .show_default();
  command.add_option("--each", options->each, "Scenes of each thing")
      .in_range(1, 1000)
      .show_default();
  command.add_option("--seed", options->seed, "Of the scenes; 0: a fresh one, which is printed")
      .show_default();
  command
      .add_option("--refine", options->refine,
                  "Number of full-order solutions that are then adopted; the touch is compared "
                  "after each")
      .in_range(0, 20)
      .show_default();
  command
      .add_option("--baked", options->baked,
                  "The body file that was baked from it: its tables are used, none are made")
      .type_name("FILE.palpable");
  command
      .add_option("--friction", options->friction,
                  "Coulomb's coefficient, of the tables' contact and of the full-order solutions; "
                  "with it things are also dragged aside, squeezes are solved twice, and those "
                  "that change with half the steps are left out. The error that tables of --baked "
                  "state is of the body file's coefficient")
      .in_range(0.0, 10.0)
      .default_is("that of the body");
  command.add_flag("--linear", options->linear, "The first stage of the tables alone");
  command
      .add_option("--pictures", options->pictures,
                  "Folder for a picture of each scene and depth: the tables' response beside the "
                  "full-order solution, and their difference")
      .type_name("DIR");
  command.add_json(options->json);
  command.footer("Example: palpable bench touch bodies/bunny-demo.toml --each 2 --json");
  command.callback([options] { bench_touch(*options); });
}

}  // namespace palpable::app

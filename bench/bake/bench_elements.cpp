// palpable-bake bench elements: accuracy of 4-node and 10-node tetrahedra for presses of a body.

#include "apps/common/command_line.h"
#include "apps/common/progress_bar.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/json.h"
#include "palpable/common/base/this_machine.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "bench/bake/bench.h"
#include "bench/bake/element_study.h"
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace palpable::app {
namespace {

struct BenchElementsOptions {
  std::string description = "bodies/bunny.toml";
  int sites = 12;
  int pressed = 6;
  std::vector<double> poisson{0.4, 0.3, 0.45};
  double edge = 0;
  bool json = false;
};

// JSON has no NaN.
Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json study_json(const ElementStudy& study, double height) {
  Json result;
  for (std::size_t s = 0; s < study.sites.size(); ++s) {
    const Eigen::Vector3d& at = study.places[s];
    result["sites"].push_back({{"at_m", {at[0], at[1], at[2]}}, {"height", at[2] / height}});
  }
  for (const ElementMemberReport& member : study.members) {
    result["meshes"].push_back({{"name", member.name},
                                {"nodes", member.nodes},
                                {"tets", member.tets},
                                {"nodes_per_tet", member.nodes_per_tet},
                                {"setup_cpu_s", member.setup_cpu_s},
                                {"path_cpu_s", member.path_cpu_s}});
  }
  for (const ElementPress& press : study.presses) {
    Json row;
    row["site"] = press.site;
    row["share"] = press.share;
    row["poisson"] = press.poisson;
    row["load_N"] = press.load;
    row["press_m"] = number(press.press);
    row["why_stopped"] = press.why_stopped;
    for (std::size_t m = 0; m < press.errors.size(); ++m) {
      row["errors"][study.members[m].name] = {
          {"press", number(press.errors[m].press)},
          {"displacement", number(press.errors[m].displacement)},
          {"element_von_mises", number(press.errors[m].element_von_mises)},
          {"nodal_von_mises", number(press.errors[m].nodal_von_mises)}};
    }
    result["presses"].push_back(std::move(row));
  }
  return result;
}

void print_elements(const char* heading, const ElementStudy& study) {
  fmt::print("{}\n", heading);
  for (const ElementMemberReport& member : study.members) {
    double paths = 0;
    for (const double seconds : member.path_cpu_s) paths += seconds;
    fmt::print(
        "  {:<15}{:>8} nodes {:>8} tetrahedra of {:<2}   set-up {:7.2f} s, a path {:7.2f} s\n",
        member.name, member.nodes, member.tets, member.nodes_per_tet, member.setup_cpu_s,
        member.path_cpu_s.empty() ? 0.0 : paths / static_cast<double>(member.path_cpu_s.size()));
  }
  fmt::print(
      "  {:>4} {:>5} {:>6} {:>9}  errors: press, displacement, von Mises stress in the elements "
      "and "
      "at nodes\n",
      "site", "nu", "share", "press/mm");
  for (const ElementPress& press : study.presses) {
    fmt::print("  {:>4} {:>5.2f} {:>6.2f} {:>9.4f}", press.site, press.poisson, press.share,
               1e3 * press.press);
    if (!press.why_stopped.empty()) {
      fmt::print("  {}\n", press.why_stopped);
      continue;
    }
    for (std::size_t m = 0; m < press.errors.size(); ++m) {
      const ElementErrors& e = press.errors[m];
      if (!std::isfinite(e.press)) continue;
      fmt::print("  | {} {:+.2f} {:.2f} {} {:.1f} %", study.members[m].name, 100 * e.press,
                 100 * e.displacement,
                 std::isfinite(e.element_von_mises)
                     ? fmt::format("{:.1f}", 100 * e.element_von_mises)
                     : "-",
                 100 * e.nodal_von_mises);
    }
    fmt::print("\n");
  }
}

ElementStudySettings settings_of(const BenchElementsOptions& options,
                                 const BodyDescription& description) {
  ElementStudySettings settings;
  settings.sites = options.sites;
  settings.pressed = std::min(options.pressed, options.sites);
  settings.poisson = options.poisson;
  settings.law = description.material.law;
  settings.young = description.material.young;
  settings.patch = description.sites.patch;
  return settings;
}

struct Studied {
  ElementStudy study;
  double height = 0, full_press = 0;  // m
};

// Studies a mesh with this edge length and finer meshes nested in it, or the mesh alone.
Studied study_body(const BenchElementsOptions& options, BodyDescription description, double edge,
                   bool nested, ProgressBar& bar) {
  ElementStudySettings settings = settings_of(options, description);
  description.shape.edge = edge;
  description.shape.order = 1;
  const BodyMesh body = make_body_mesh(description);
  if (!body.supports.empty()) {
    throw Error(fmt::format("{}: the bench knows supports that hold all directions only",
                            options.description));
  }
  SolidModel model;
  model.mesh = body.mesh;
  model.fixed_nodes = body.fixed_nodes;
  settings.lowest = description.sites.above * body.height;
  settings.press = description.press.depth * body.height;
  const char* task = nested ? "nested meshes" : "the body's mesh";
  return {study_elements(nested ? nested_family(model) : single_family(model), settings,
                         [&](ProgressReport r) {
                           r.task = task;
                           bar.show(r);
                         }),
          body.height, settings.press};
}

Json element_figures(const BenchElementsOptions& options, const BodyDescription& description,
                     const Studied& nested, const Studied& direct) {
  Json result;
  result["date"] = date_today();
  result["machine"] = processor_name();
  result["command"] = fmt::format(
      "palpable bench elements {}{} --sites {} --pressed {} --poisson {} --json",
      options.description, options.edge > 0.0 ? " --edge " + length_text(options.edge) : "",
      options.sites, options.pressed, fmt::join(options.poisson, " "));
  result["title"] = "4-node and 10-node tetrahedra";
  result["order"] = 50;
  result["text"] =
      "Which element is truer at the same nodes and at the same cost: tables of these figures are "
      "in [verification.md](verification.md).";
  result["body"] = description.name;
  result["description"] = std::filesystem::path(options.description).filename().string();
  result["law"] = description.material.law;
  result["edge_m"] = *description.shape.edge;
  result["height_m"] = direct.height;
  result["full_press_m"] = direct.full_press;
  result["nested"] = study_json(nested.study, nested.height);
  result["direct"] = study_json(direct.study, direct.height);
  return result;
}

void bench_elements(const BenchElementsOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  BodyDescription description = read_body_description(options.description);
  if (options.edge > 0.0) description.shape.edge = options.edge;
  if (!description.shape.edge || !description.material.constants.empty()) {
    throw Error(
        fmt::format("{}: the bench needs an edge in [shape], because it meshes the body "
                    "with twice that edge, too, and a material by young and poisson",
                    options.description));
  }
  ProgressBar bar;
  // A mesh with twice the edge length, split in eight, has the body's edge length.
  const double edge = *description.shape.edge;
  const Studied nested = study_body(options, description, 2.0 * edge, true, bar);
  const Studied direct = study_body(options, description, edge, false, bar);
  bar.finish();
  if (!options.json) {
    print_elements("One body on nested meshes:", nested.study);
    print_elements("The body's own mesh:", direct.study);
    return;
  }
  Json result = element_figures(options, description, nested, direct);
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
  result["wall_s"] = wall.count();
  fmt::print("{}\n", result.dump(1));
}

}  // namespace

void add_bench_elements(Command bench) {
  const auto options = std::make_shared<BenchElementsOptions>();
  Command command = bench.add_subcommand(
      "elements", "How true 4-node and 10-node tetrahedra are on a body's presses");
  command.add_option("body", options->description, "The body, with an edge in [shape]")
      .type_name("FILE.toml")
      .show_default();
  command.add_option("--sites", options->sites, "Sites pressed by a small load")
      .in_range(1, 1000)
      .show_default();
  command.add_option("--pressed", options->pressed, "How many of them are pressed in earnest")
      .in_range(0, 1000)
      .show_default();
  command.add_option("--poisson", options->poisson, "Poisson's ratios; the first for the presses")
      .in_range(0.0, 0.499)
      .show_default();
  command.add_length("--edge", options->edge, "Edge length of the mesh")
      .default_is("the description's");
  command.add_json(options->json);
  command.footer(
      "Solves on eight times the nodes for comparison: 10 GB of memory and half an hour for a "
      "body "
      "of 17,000 nodes.\n"
      "Example: palpable bench elements bodies/bunny.toml --json");
  command.callback([options] { bench_elements(*options); });
}

}  // namespace palpable::app

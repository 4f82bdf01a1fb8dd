#include "bench/bake/solid_tables.h"

#include <fmt/format.h>

#include <utility>

namespace palpable::app {
namespace {

// One path per row: those of the sites, and those of the body with 10-node tetrahedra.
Json paths_table(const Json& result) {
  const bool with_calculix = result.contains("ratio_to_ccx");
  Json paths = {{"columns",
                 {"site", "at height", "press", "ours, CPU s", "set-up of it", "Newton steps",
                  "CG iterations"}},
                {"rows", Json::array()}};
  if (with_calculix) {
    for (const char* column : {"CalculiX, CPU s", "ratio", "difference of u", "of stress"}) {
      paths["columns"].push_back(column);
    }
  }
  const auto add = [&](const Json& site, const std::string& name) {
    Json row = {name,
                fmt::format("{:.0f} mm", 1e3 * site["at_m"][2].get<double>()),
                fmt::format("{:.1f} %", 100 * site["press_fraction"].get<double>()),
                site["cpu_s"],
                site["setup_s"],
                site["newton_steps"],
                site["cg_iterations"]};
    if (with_calculix && site.contains("ccx_cpu_s")) {
      row.push_back(site["ccx_cpu_s"]);
      row.push_back(site["ratio_to_ccx"]);
      row.push_back(fmt::format("{:.1e}", site["max_rel_difference_u"].get<double>()));
      row.push_back(fmt::format("{:.1e}", site["max_rel_difference_stress"].get<double>()));
    } else if (with_calculix) {
      for (int k = 0; k < 4; ++k) row.push_back(nullptr);
    }
    paths["rows"].push_back(std::move(row));
  };
  for (const Json& site : result["sites"]) add(site, std::to_string(site["site"].get<int>()));
  for (const Json& site : result["ten_node"]["sites"]) {
    add(site, fmt::format("10-node, {} nodes", result["ten_node"]["nodes"].get<int>()));
  }
  return paths;
}

Json stages_table(const Json& result) {
  Json stages = {
      {"heading", "Where our CPU time goes"},
      {"columns",
       {"site", "pattern, ordering", "tangent", "factor", "solve", "forces", "rest", "all, s"}},
      {"rows", Json::array()}};
  for (const Json& site : result["sites"]) {
    const Json& s = site["stages_s"];
    stages["rows"].push_back({std::to_string(site["site"].get<int>()), s["pattern_and_ordering"],
                              s["tangent"], s["factor"], s["solve"], s["force"], s["rest"],
                              site["cpu_s"]});
  }
  return stages;
}

Json floor_table(const Json& result) {
  const Json& floor = result["floor"];
  Json least = {
      {"heading", "What this machine would take at least"},
      {"text",
       fmt::format("One factor, and for each level one pass over the elements for the forces, one "
                   "for a product with the tangent, and one application of the factor: **{:.3g} "
                   "s**. Memory at the rate of a copy between arrays as large as the factor, "
                   "{:.3g} GB/s; operations in single precision at the rate of multiply-adds in "
                   "registers, {:.3g} GFlop/s ({}); nothing kept in a cache. Peak memory of the "
                   "program: {:.0f} MB.",
                   result["floor_s"].get<double>(), 1e-9 * floor["copy_bytes_per_s"].get<double>(),
                   1e-9 * floor["flops_per_s"].get<double>(), floor["vectors"].get<std::string>(),
                   1e-6 * result["memory_bytes"].get<double>())},
      {"columns", {"once", "MB", "MFlop", "ms"}},
      {"rows", Json::array()}};
  const auto add = [&](const char* what, double bytes, double flops, double seconds) {
    least["rows"].push_back({what, 1e-6 * bytes, 1e-6 * flops, 1e3 * seconds});
  };
  const auto of = [&](const char* key) { return floor[key].get<double>(); };
  add("pass over the elements", of("element_pass_bytes"), of("element_pass_flops"),
      of("element_pass_s"));
  add("application of the factor, read twice", of("factor_bytes"), of("factor_bytes"),
      of("factor_application_s"));
  add("factor", of("factor_bytes"), of("factor_flops"), of("factor_s"));
  return least;
}

}  // namespace

std::string solid_section_text(const Json& result, const std::string& law, int levels,
                               double tolerance) {
  std::string text = fmt::format(
      "{}: {} nodes, {} linear tetrahedra, {}, {} levels, from rest to {:.1f} % of the height at "
      "the least; both programs to a residual of {:g}, each with one thread. CPU time of ours is "
      "all of one path: the solver made, its factor included, and the path; the search for the "
      "load is in neither.",
      result["body"].get<std::string>(), result["nodes"].get<int>(), result["tets"].get<int>(), law,
      levels, 100 * result["press_fraction"].get<double>(), tolerance);
  if (!result.contains("ratio_to_ccx")) return text;  // without CalculiX
  return text + fmt::format(" Medians: {:.2f} s against {:.0f} s, **{:.0f} times less**.",
                            result["path_cpu_s"].get<double>(), result["ccx_cpu_s"].get<double>(),
                            result["ratio_to_ccx"].get<double>());
}

Json solid_section_tables(const Json& result) {
  return Json::array({paths_table(result), stages_table(result), floor_table(result)});
}

}  // namespace palpable::app

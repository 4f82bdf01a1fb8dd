#include "palpable/bake/exchange/body_page.h"

#include "palpable/bake/exchange/web_page.h"
#include "palpable/common/base/base64.h"
#include "palpable/common/base/json.h"
#include "palpable/common/base/order_statistics.h"
#include "palpable/common/body_file/touch_text.h"
#include "palpable/common/geometry/size_text.h"
#include "palpable/common/reduced/spline.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <vector>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXf;
using Eigen::VectorXd;

constexpr int kModesShown = 6;

bool has_blocks(const SeparatedField& field) { return field.largest_block() < field.mode_count(); }

// ---- numbers ---------------------------------------------------------------------------------

Json list(const auto& values) {
  Json result = Json::array();
  for (const auto value : values) result.push_back(static_cast<double>(value));
  return result;
}

std::vector<float> numbers_of(const auto& values) {
  std::vector<float> numbers;
  for (Index c = 0; c < values.cols(); ++c) {
    for (Index r = 0; r < values.rows(); ++r) numbers.push_back(values(r, c));
  }
  return numbers;
}

template <class T>
std::string packed(const std::vector<T>& values) {
  std::string bytes(values.size() * sizeof(T), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return base64(bytes);
}

double bytes_of_modes(const SeparatedField& field, bool half) {
  return (half ? 2.0 : 4.0) * static_cast<double>(field.modes().size());
}

double bytes_of_functions(const SeparatedField& field) {
  double values = 0;
  for (const ParameterAxis& axis : field.axes())
    values += static_cast<double>(axis.functions.size());
  return 8.0 * values;
}

// ---- the courses of the errors -----------------------------------------------------------------

std::string axis_label(const std::string& method, const SeparatedField& field, bool by_file) {
  if (method == "hosvd" && !by_file) return "functions of space";
  if (method == "per-site" || (by_file && has_blocks(field))) return "modes of each site";
  return "modes of all sites together";
}

Json course_json(const std::optional<ErrorCourse>& course, const std::string& axis,
                 const std::string& what) {
  if (!course) return nullptr;
  Json result{{"axis", axis}, {"what", what}, {"count", course->snapshots.rows()}};
  result["modes"] = std::vector<int>(course->modes.begin(), course->modes.end());
  result["pooled"] = list(course->pooled);
  for (const char* key : {"p05", "median", "p95", "worst"}) result[key] = Json::array();
  for (Index q = 0; q < course->modes.size(); ++q) {
    std::vector<float> errors = numbers_of(course->snapshots.col(q));
    result["p05"].push_back(percentile({errors.begin(), errors.end()}, 0.05));
    result["median"].push_back(upper_median(errors));
    result["p95"].push_back(percentile({errors.begin(), errors.end()}, 0.95));
    result["worst"].push_back(course->snapshots.col(q).maxCoeff());
  }
  return result;
}

// Errors with all modes, a row for each site and a column for each level; with further parameters
// the largest over their values.
Json snapshots_json(const std::optional<ErrorCourse>& course, const ReducedBody& body,
                    const std::string& where) {
  if (!course) return nullptr;
  const auto S = static_cast<Index>(body.sites.size());
  const Index L = body.levels().size() - 1, P = course->snapshots.rows() / (S * L);
  const auto all = course->snapshots.rightCols(1);
  Json rows = Json::array();
  for (Index s = 0; s < S; ++s) {
    Json row = Json::array();
    for (Index l = 0; l < L; ++l) {
      row.push_back(static_cast<double>(all.middleRows((s * L + l) * P, P).maxCoeff()));
    }
    rows.push_back(std::move(row));
  }
  return {{"values", std::move(rows)},
          {"what", P > 1 ? where + "; the worst over the further parameters" : where}};
}

Json held_out_json(const std::optional<HeldOutRecord>& held_out) {
  if (!held_out) return nullptr;
  Json result{{"levels", list(held_out->levels)},
              {"count", held_out->displacement.size()},
              {"displacement_pooled", held_out->displacement_pooled}};
  for (const auto& [name, errors] : {std::pair{"displacement", &held_out->displacement},
                                     std::pair{"von_mises", &held_out->von_mises}}) {
    Json rows = Json::array();
    for (Index s = 0; s < errors->cols(); ++s) rows.push_back(list(errors->col(s)));
    result[name] = std::move(rows);
    std::vector<float> all = numbers_of(*errors);
    result[fmt::format("{}_median", name)] = upper_median(all);
    result[fmt::format("{}_worst", name)] = static_cast<double>(errors->maxCoeff());
  }
  return result;
}

// ---- the modes ---------------------------------------------------------------------------------

// Sites that lie far from each other, beginning with the highest.
std::vector<int> sites_apart(const ReducedBody& body, std::size_t count) {
  const auto place = [&](int s) { return body.surface.vertices.col(body.sites[s].vertex); };
  const auto S = static_cast<int>(body.sites.size());
  int best = 0;
  for (int s = 1; s < S; ++s) {
    if (place(s).z() > place(best).z()) best = s;
  }
  std::vector<int> chosen{best};
  while (chosen.size() < std::min<std::size_t>(count, body.sites.size())) {
    double farthest = -1;
    for (int s = 0; s < S; ++s) {
      double nearest = std::numeric_limits<double>::infinity();
      for (const int c : chosen) nearest = std::min(nearest, (place(s) - place(c)).norm());
      if (nearest > farthest) {
        farthest = nearest;
        best = s;
      }
    }
    chosen.push_back(best);
  }
  return chosen;
}

struct ShownMode {
  int column = 0;
  std::string title;
  int site = -1;  // that the mode belongs to; -1: all
};

// With modes of their own per site, three of one site and the first of three others; else the first
// six.
std::vector<ShownMode> modes_to_show(const ReducedBody& body, const SeparatedField& field) {
  std::vector<ShownMode> shown;
  if (!has_blocks(field)) {
    for (int i = 0; i < std::min(kModesShown, field.mode_count()); ++i) {
      shown.push_back({i, fmt::format("Mode {}", i + 1)});
    }
    return shown;
  }
  for (const int site : sites_apart(body, kModesShown)) {
    const auto [first, last] = field.block(0, site);
    const int wanted = shown.empty() ? 3 : 1;
    for (int i = first; i < std::min(last, first + wanted); ++i) {
      if (static_cast<int>(shown.size()) == kModesShown) return shown;
      shown.push_back({i, fmt::format("Site {}, mode {}", site, i - first + 1), site});
    }
  }
  return shown;
}

// The product of the largest values that the mode's functions have at their samples.
double largest_weight(const SeparatedField& field, int mode) {
  double weight = 1;
  for (const ParameterAxis& axis : field.axes()) {
    weight *= axis.functions.col(mode).cwiseAbs().maxCoeff();
  }
  return weight;
}

Json modes_json(const ReducedBody& body, const SeparatedField& field, double unit,
                const char* unit_name) {
  Json result = Json::array();
  for (const ShownMode& mode : modes_to_show(body, field)) {
    const Eigen::VectorXd F =
        field.modes().col(mode.column).cast<double>() * largest_weight(field, mode.column);
    const double largest = F.cwiseAbs().maxCoeff();
    if (!(largest > 0.0)) continue;  // snapshots without stress
    std::vector<std::int16_t> steps;
    for (const double f : F)
      steps.push_back(static_cast<std::int16_t>(std::lround(f / largest * 32767)));
    std::string what = fmt::format("a component reaches {:.3g} {}", largest * unit, unit_name);
    if (mode.site >= 0) {
      what += fmt::format("; the site bears {:.3g} N and is pressed {:.3g} mm",
                          body.sites[mode.site].full_load,
                          body.press_depth(body.press_depth.rows() - 1, mode.site) * 1e3);
    }
    Json shown{{"title", mode.title},
               {"what", what},
               {"column", mode.column},
               {"scale", largest / 32767},
               {"data", packed(steps)}};
    if (mode.site >= 0) shown["site"] = mode.site;
    result.push_back(std::move(shown));
  }
  return result;
}

// One function, scaled so that its largest sample is 1, and interpolated as evaluation does.
Json curve_json(const ParameterAxis& axis, int mode, const std::string& label, const VectorXd& at) {
  const VectorXd g = axis.functions.col(mode);
  const double largest = std::max(g.cwiseAbs().maxCoeff(), 1e-300);
  const Eigen::MatrixXd slopes = spline_slopes(axis.samples, g);
  Json values = Json::array();
  for (const double x : at) {
    const CubicWeights w = cubic_weights(axis.samples, x);
    values.push_back((w.value[0] * g[w.left] + w.value[1] * slopes(w.left, 0) +
                      w.value[2] * g[w.right] + w.value[3] * slopes(w.right, 0)) /
                     largest);
  }
  return {{"label", label}, {"values", std::move(values)}};
}

Json functions_json(const ReducedBody& body, const SeparatedField& field) {
  Json result = Json::array();
  for (std::size_t j = 0; j < field.axes().size(); ++j) {
    const ParameterAxis& axis = field.axes()[j];
    const bool choice = axis.between == Between::kNothing;
    if (choice && has_blocks(field)) continue;  // such functions are 1 at one site and 0 elsewhere
    if (axis.samples.size() < 2) continue;
    VectorXd at = axis.samples;
    if (!choice) {
      constexpr Index kSteps = 8;  // of a curve between two samples
      at.resize(kSteps * (axis.samples.size() - 1) + 1);
      for (Index i = 0; i < at.size(); ++i) {
        const Index k = std::min(i / kSteps, axis.samples.size() - 2);
        at[i] = axis.samples[k] + (axis.samples[k + 1] - axis.samples[k]) *
                                      static_cast<double>(i - k * kSteps) / double{kSteps};
      }
    }
    Json curves = Json::array();
    for (const ShownMode& mode : modes_to_show(body, field)) {
      if (largest_weight(field, mode.column) == 0.0) continue;
      curves.push_back(curve_json(axis, mode.column, mode.title, at));
    }
    if (curves.size() == 0) continue;
    const bool level = axis.name == "level";
    result.push_back({{"name", axis.name},
                      {"title", fmt::format("Functions of the {}", axis.name)},
                      {"label", level ? "level (share of the full load)" : axis.name},
                      {"what", choice ? "One value for each site; between sites there is nothing"
                                      : "Cubic splines through the samples, as they are evaluated"},
                      {"choice", choice},
                      {"x", list(at)},
                      {"curves", std::move(curves)}});
  }
  return result;
}

Json mesh_json(const SurfaceMesh& surface) {
  const Eigen::Vector3d low = surface.vertices.rowwise().minCoeff();
  const Eigen::Vector3d size = (surface.vertices.rowwise().maxCoeff() - low).cwiseMax(1e-9);
  std::vector<std::uint16_t> steps;
  for (const auto vertex : surface.vertices.colwise()) {
    for (int k = 0; k < 3; ++k) {
      steps.push_back(
          static_cast<std::uint16_t>(std::lround((vertex[k] - low[k]) / size[k] * 65535)));
    }
  }
  const bool wide = surface.vertex_count() > 65535;
  Json mesh{{"low", list(low)}, {"size", list(size)}, {"vertices", packed(steps)}, {"wide", wide}};
  if (wide) {
    std::vector<std::uint32_t> corners;
    for (const int v : surface.triangles.reshaped())
      corners.push_back(static_cast<std::uint32_t>(v));
    mesh["triangles"] = packed(corners);
  } else {
    std::vector<std::uint16_t> corners;
    for (const int v : surface.triangles.reshaped())
      corners.push_back(static_cast<std::uint16_t>(v));
    mesh["triangles"] = packed(corners);
  }
  return mesh;
}

std::string form_text(const SeparatedField& field) {
  return has_blocks(field) ? fmt::format("{} modes in blocks, up to {} for each site",
                                         field.mode_count(), field.largest_block())
                           : fmt::format("{} modes for all sites", field.mode_count());
}

std::string modes_text(const SeparatedField& field, const char* what) {
  return fmt::format(
      "The first spatial functions F of {}, of {} in all{}. Each is multiplied by the largest "
      "value that its parameter functions G reach together, so that the scale says what the mode "
      "contributes at most.",
      what, field.mode_count(),
      has_blocks(field) ? fmt::format(": each site has its own, up to {}; those of one site, and "
                                      "the first of others",
                                      field.largest_block())
                        : std::string(", the same for every site"));
}

Json field_json(const SeparatedField& field, double pooled, double worst, double rounding) {
  return {{"pooled", pooled},
          {"worst", worst},
          {"modes", field.mode_count()},
          {"modes_per_touch", field.largest_block()},
          {"bytes", bytes_of_modes(field, rounding > 0.0) + bytes_of_functions(field)}};
}

std::string megabytes(double bytes) { return fmt::format("{:.3g} MB", bytes / 1e6); }

Json costs_json(const ReducedBody& body, const BodyPageFacts& facts) {
  Json rows = Json::array();
  const auto add = [&](const char* name, const std::string& text) { rows.push_back({name, text}); };
  add("body file",
      fmt::format("{}, {:.1f} MB", facts.file, static_cast<double>(facts.file_bytes) / 1e6));
  for (const auto& [name, field, rounding] :
       {std::tuple{"displacement", &body.displacement, body.error.displacement_rounding},
        std::tuple{"stress", &body.stress, body.error.stress_rounding}}) {
    add(name,
        fmt::format("{}; {} values each in {} precision, {}; functions of the parameters {}{}",
                    form_text(*field), field->value_count(), rounding > 0 ? "half" : "single",
                    megabytes(bytes_of_modes(*field, rounding > 0)),
                    megabytes(bytes_of_functions(*field)),
                    rounding > 0 ? fmt::format("; rounding adds an error of {:.2g}", rounding)
                                 : std::string()));
  }
  add("one evaluation",
      fmt::format("displacement {:.3g} µs, stress {:.3g} µs; both and von Mises stress {:.3g} µs. "
                  "Medians of {} over sites and levels, one core, measured by this command on {}",
                  facts.displacement_us, facts.stress_us, facts.all_us, facts.repeats, facts.date));
  add("measured on", facts.processor);
  return rows;
}

// The provenance, and those of its texts that stand beside the errors, too.
void add_provenance(const Provenance& provenance, Json& data) {
  data["provenance"] = Json::array();
  for (const auto& [key, value] : lines_of(provenance)) data["provenance"].push_back({key, value});
  Json held_out = Json::array(), between_sites = Json::array();
  if (!provenance.held_out.empty()) held_out.push_back(provenance.held_out);
  for (const auto& at : provenance.held_out_values) held_out.push_back(at.errors);
  if (!provenance.between_sites.empty()) between_sites.push_back(provenance.between_sites);
  data["notes"] = {{"held_out", held_out}, {"between_sites", between_sites}};
}

std::string lead_text(const ReducedBody& body) {
  const Eigen::Vector3d size = extent_of(body.surface.vertices) * 1e3;
  const std::string& method = body.method;
  std::string further;
  for (const FurtherParameter& p : body.further) {
    further += fmt::format(" x {} of {}", p.samples.size(), p.name);
  }
  return fmt::format(
      "{:.0f} x {:.0f} x {:.0f} mm, {} vertices on the surface; {}. {} sites x {} levels{}{}.",
      size.x(), size.y(), size.z(), body.surface.vertex_count(), body.material, body.sites.size(),
      body.levels().size() - 1, further,
      method.empty() ? "" : fmt::format(", reduced by the method {}", method));
}

// Builds the CSV: one figure a line, with what it is, its field and its parameters.
struct Table {
  std::string text = fmt::format("{}\n", kBodyTableHeader);

  void add(std::string_view quantity, std::string_view field, std::string_view modes,
           std::string_view site, std::string_view level, std::string_view further, double value,
           std::string_view unit) {
    text += fmt::format("{},{},{},{},{},{},{:.9g},{}\n", quantity, field, modes, site, level,
                        csv_cell(further), value, unit);
  }
};

void add_errors(Table& table, const ReductionError& error) {
  table.add("error_all_together", "displacement", "", "", "", "", error.displacement_pooled, "1");
  table.add("error_worst", "displacement", "", "", "", "", error.displacement_worst, "1");
  table.add("error_all_together", "stress", "", "", "", "", error.stress_pooled, "1");
  table.add("error_worst", "stress", "", "", "", "", error.stress_worst, "1");
  table.add("error_of_rounding", "displacement", "", "", "", "", error.displacement_rounding, "1");
  table.add("error_of_rounding", "stress", "", "", "", "", error.stress_rounding, "1");
  if (error.between_sites) {
    table.add("error_between_sites", "", "", "", "", "", *error.between_sites, "1");
  }
}

void add_sizes_and_times(Table& table, const ReducedBody& body, const BodyPageFacts& facts) {
  const ReductionError& error = body.error;
  for (const auto& [name, field, rounding, us] :
       {std::tuple{"displacement", &body.displacement, error.displacement_rounding,
                   facts.displacement_us},
        std::tuple{"stress", &body.stress, error.stress_rounding, facts.stress_us}}) {
    table.add("bytes_of_modes", name, fmt::to_string(field->mode_count()), "", "", "",
              bytes_of_modes(*field, rounding > 0), "B");
    table.add("bytes_of_functions", name, fmt::to_string(field->mode_count()), "", "", "",
              bytes_of_functions(*field), "B");
    table.add("evaluation", name, fmt::to_string(field->largest_block()), "", "", "", us, "us");
  }
  table.add("evaluation", "all", "", "", "", "", facts.all_us, "us");
}

// The error over the number of modes, of all snapshots and of each.
void add_courses(Table& table, const ReducedBody& body) {
  const ReductionError& error = body.error;
  const VectorXd& levels = body.levels();
  const Index L = levels.size() - 1;
  for (const auto& [name, course] : {std::pair{"displacement", &error.displacement_course},
                                     std::pair{"stress", &error.stress_course},
                                     std::pair{"von_mises", &error.von_mises_course}}) {
    if (!*course) continue;
    const MatrixXf& snapshots = (*course)->snapshots;
    const Index P = snapshots.rows() / (L * static_cast<Index>(body.sites.size()));
    for (Index q = 0; q < (*course)->modes.size(); ++q) {
      const std::string modes = fmt::to_string((*course)->modes[q]);
      std::vector<float> errors = numbers_of(snapshots.col(q));
      table.add("error_all_together", name, modes, "", "", "", (*course)->pooled[q], "1");
      table.add("error_median", name, modes, "", "", "", static_cast<double>(upper_median(errors)),
                "1");
      table.add("error_worst", name, modes, "", "", "",
                static_cast<double>(snapshots.col(q).maxCoeff()), "1");
      for (Index k = 0; k < snapshots.rows(); ++k) {
        table.add("error_snapshot", name, modes, fmt::to_string(k / P / L),
                  fmt::format("{:.6g}", levels[1 + k / P % L]),
                  P > 1 ? fmt::format("combination {}", k % P) : std::string(),
                  static_cast<double>(snapshots(k, q)), "1");
      }
    }
  }
}

void add_held_out(Table& table, const ReductionError& error) {
  const auto& held_out = error.held_out;
  if (!held_out) return;
  table.add("held_out_all_together", "displacement", "", "", "", "", held_out->displacement_pooled,
            "1");
  for (const auto& [name, errors] : {std::pair{"displacement", &held_out->displacement},
                                     std::pair{"von_mises", &held_out->von_mises}}) {
    for (Index s = 0; s < errors->cols(); ++s) {
      for (Index l = 0; l < errors->rows(); ++l) {
        table.add("held_out", name, "", fmt::to_string(s),
                  fmt::format("{:.6g}", held_out->levels[l]), "",
                  static_cast<double>((*errors)(l, s)), "1");
      }
    }
  }
}

void add_touches(Table& table, const std::vector<HeldOutTouch>& touches) {
  for (const HeldOutTouch& touch : touches) {
    const std::string what = fmt::format("{} {:.3g} mm", name_of(touch.thing), 1e3 * touch.depth);
    for (const auto& [field, difference] : kHeldOutDifferences) {
      table.add("held_out_touch", field, "", "", "", what, touch.*difference, "1");
    }
  }
}

// The functions of each parameter; not those of the site if each site has modes of its own.
void add_functions(Table& table, const ReducedBody& body) {
  for (const auto& [name, field] :
       {std::pair{"displacement", &body.displacement}, std::pair{"stress", &body.stress}}) {
    for (std::size_t j = 0; j < field->axes().size(); ++j) {
      const ParameterAxis& axis = field->axes()[j];
      if (j == 0 && has_blocks(*field)) continue;
      for (Index i = 0; i < axis.functions.cols(); ++i) {
        for (Index k = 0; k < axis.samples.size(); ++k) {
          const std::string at = fmt::format("{:.6g}", axis.samples[k]);
          table.add("function_of_" + (j < 2 ? axis.name : std::string("further")), name,
                    fmt::to_string(i + 1), j == 0 ? at : "", j == 1 ? at : "",
                    j > 1 ? axis.name + "=" + at : "", axis.functions(k, i), "1");
        }
      }
    }
  }
}

}  // namespace

std::string body_page(const ReducedBody& body, const BodyPageFacts& facts,
                      const std::string& csv_name) {
  const ReductionError& error = body.error;
  const std::string& method = body.method;
  Json data;
  data["name"] = body.name;
  data["file"] = {{"name", facts.file}, {"bytes", facts.file_bytes}};
  data["fields"]["displacement"] =
      field_json(body.displacement, error.displacement_pooled, error.displacement_worst,
                 error.displacement_rounding);
  data["fields"]["stress"] =
      field_json(body.stress, error.stress_pooled, error.stress_worst, error.stress_rounding);
  const std::string volume = "Integral over the volume";
  const std::string skin = "Integral over the skin, first modes as evaluated";
  data["courses"] = {
      {"displacement", course_json(error.displacement_course,
                                   axis_label(method, body.displacement, false), volume)},
      {"stress", course_json(error.stress_course, axis_label(method, body.stress, false),
                             volume + ", all six components")},
      {"von_mises",
       course_json(error.von_mises_course, axis_label(method, body.stress, true), skin)}};
  data["levels"] = list(body.levels().tail(body.levels().size() - 1));
  data["snapshots"] = {
      {"displacement", snapshots_json(error.displacement_course, body, volume)},
      {"stress", snapshots_json(error.stress_course, body, volume)},
      {"von_mises", snapshots_json(error.von_mises_course, body, "Integral over the skin")}};
  data["held_out"] = held_out_json(error.held_out);
  data["between_sites"] = error.between_sites ? Json(*error.between_sites) : Json(nullptr);
  data["touch"] = {{"text", facts.touch}, {"held_out", touches_json(facts.held_out)}};
  data["timing"] = {{"displacement_us", facts.displacement_us},
                    {"stress_us", facts.stress_us},
                    {"all_us", facts.all_us},
                    {"repeats", facts.repeats},
                    {"processor", facts.processor},
                    {"date", facts.date}};
  data["mesh"] = mesh_json(body.surface);
  data["modes"] = {{"displacement", modes_json(body, body.displacement, 1e3, "mm")},
                   {"stress", modes_json(body, body.stress, 1e-3, "kPa")}};
  data["functions"] = {{"displacement", functions_json(body, body.displacement)},
                       {"stress", functions_json(body, body.stress)}};
  data["costs"] = costs_json(body, facts);
  add_provenance(body.provenance, data);
  return web_page(
      {.title = fmt::format("{}: what its reduction gives up", body.name),
       .content = "body.html",
       .scripts = {"modes.js", "body.js"},
       .texts = {{"lead", lead_text(body)},
                 {"displacement_modes", modes_text(body.displacement, "displacement")},
                 {"stress_modes", modes_text(body.stress, "stress (Cauchy)")},
                 {"footer", fmt::format("Written by {} on {} from {}; the same numbers are in {}.",
                                        facts.program, facts.date, facts.file, csv_name)}},
       .data = data.dump()});
}

std::string body_table(const ReducedBody& body, const BodyPageFacts& facts) {
  Table table;
  add_errors(table, body.error);
  table.add("bytes_of_file", "", "", "", "", "", static_cast<double>(facts.file_bytes), "B");
  add_sizes_and_times(table, body, facts);
  add_courses(table, body);
  add_held_out(table, body.error);
  add_touches(table, facts.held_out);
  add_functions(table, body);
  return table.text;
}

}  // namespace palpable

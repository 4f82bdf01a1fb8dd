#include "palpable/common/body_file/body_file_groups.h"

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace palpable::body_file {
namespace {

using hdf5::Handle;
using hdf5::has;
using hdf5::has_link;
using hdf5::open_group;
using hdf5::read_number;
using hdf5::read_table;
using hdf5::read_text;
using hdf5::require;
using hdf5::Table;

template <class T>
bool all_finite(const std::vector<T>& values) {
  for (const T v : values) {
    if (!std::isfinite(v)) return false;
  }
  return true;
}

template <class Matrix, class T>
Matrix as_matrix(const Table<T>& table) {  // dataset rows become columns
  return Eigen::Map<const Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>>(
      table.data.data(), static_cast<Eigen::Index>(table.columns),
      static_cast<Eigen::Index>(table.rows));
}

bool increases_strictly(const auto& values) {
  for (Eigen::Index i = 1; i < values.size(); ++i) {
    if (!(values[i - 1] < values[i])) return false;
  }
  return true;
}

ParameterAxis read_axis(hid_t field, int number, hsize_t m) {
  const Handle g = open_group(field, fmt::format("axis_{}", number).c_str());
  ParameterAxis axis;
  axis.name = read_text(g, "name");
  const std::string text = read_text(g, "between");
  require(text == kNothing || text == kSpline,
          fmt::format("axis '{}' is interpolated by '{}', which this program does not know",
                      axis.name, text));
  axis.between = text == kSpline ? Between::kSmooth : Between::kNothing;
  const Table<double> samples = read_table<double>(g, "samples");
  require(samples.columns == 1 && samples.rows >= 1, "an axis has no samples");
  require(all_finite(samples.data), "an axis has samples that are not numbers");
  axis.samples = Eigen::Map<const Eigen::VectorXd>(samples.data.data(),
                                                   static_cast<Eigen::Index>(samples.rows));
  require(increases_strictly(axis.samples),
          fmt::format("the samples of axis '{}' do not increase", axis.name));
  const Table<double> functions = read_table<double>(g, "functions", m, samples.rows);
  require(all_finite(functions.data), "a parameter function is not a number somewhere");
  axis.functions = as_matrix<Eigen::MatrixXd>(functions);
  return axis;
}

Eigen::MatrixXf read_modes(hid_t group) {
  if (!has_link(group, "modes_float16")) {
    return as_matrix<Eigen::MatrixXf>(read_table<float>(group, "modes"));
  }
  const Table<Eigen::half> halves = read_table<Eigen::half>(group, "modes_float16");
  const Table<double> scales = read_table<double>(group, "mode_scale", halves.rows, 1);
  require(all_finite(scales.data), "the scale of a mode is not a number");
  const auto m = static_cast<Eigen::Index>(halves.rows);
  return as_matrix<Eigen::Matrix<Eigen::half, Eigen::Dynamic, Eigen::Dynamic>>(halves)
             .cast<float>() *
         Eigen::Map<const Eigen::VectorXd>(scales.data.data(), m).cast<float>().asDiagonal();
}

SeparatedField read_field(hid_t file, const char* name, hsize_t value_count, double& rounding) {
  const Handle group = open_group(file, name);
  Eigen::MatrixXf modes = read_modes(group);
  require(modes.cols() >= 1, fmt::format("'{}' has no modes", name));
  require(static_cast<hsize_t>(modes.rows()) == value_count,
          fmt::format("the modes of '{}' have {} values where {} are needed", name, modes.rows(),
                      value_count));
  require(modes.allFinite(), fmt::format("a mode of '{}' is not a number somewhere", name));
  rounding = read_number(group, "rounding");
  require(rounding >= 0 && std::isfinite(rounding), "the error of rounding is not valid");
  const double count = read_number(group, "axes");
  require(count >= 2 && count <= SeparatedField::kMostAxes,
          fmt::format("'{}' does not depend on site and level", name));
  std::vector<ParameterAxis> axes;
  for (int j = 0; j < static_cast<int>(count); ++j) {
    axes.push_back(read_axis(group, j, static_cast<hsize_t>(modes.cols())));
    const char* needed = j == 0 ? "site" : j == 1 ? "level" : axes.back().name.c_str();
    require(axes.back().name == needed,
            fmt::format("axis {} is '{}' where '{}' is needed", j, axes.back().name, needed));
    require((axes.back().between == Between::kNothing) == (j == 0),
            fmt::format("'{}' is {} quantity", needed, j == 0 ? "no" : "a"));
  }
  return {std::move(modes), std::move(axes)};
}

void read_surface(hid_t file, ReducedBody& body) {
  const Handle g = open_group(file, "surface");
  const Table<double> vertices = read_table<double>(g, "vertices");
  const Table<int> triangles = read_table<int>(g, "triangles");
  require(vertices.columns == 3 && vertices.rows >= 4, "the surface has too few vertices");
  require(triangles.columns == 3, "the surface's triangles do not have three corners");
  require(all_finite(vertices.data), "a vertex is not a number");
  body.surface.vertices = as_matrix<Eigen::Matrix3Xd>(vertices);
  body.surface.triangles = as_matrix<Eigen::Matrix3Xi>(triangles);
  const WatertightReport report = check_watertight(body.surface);
  require(report.watertight(), "the surface is " + report.describe());
  body.fixed = read_table<std::uint8_t>(g, "fixed", vertices.rows, 1).data;
}

// @param what  "site" or "reaction", for messages
std::vector<Site> read_loaded_places(hid_t g, int V, const char* what) {
  const Table<int> vertex = read_table<int>(g, "vertex");
  const hsize_t S = vertex.rows;
  require(S >= 1 && vertex.columns == 1, fmt::format("the body has no {}", what));
  const Table<double> direction = read_table<double>(g, "direction", S, 3);
  const Table<double> full_load = read_table<double>(g, "full_load", S, 1);
  const Table<int> begin = read_table<int>(g, "patch_begin", S + 1, 1);
  const Table<int> patch = read_table<int>(g, "patch");
  const Table<float> weights = read_table<float>(g, "patch_weights", patch.rows, 1);
  require(all_finite(direction.data) && all_finite(full_load.data) && all_finite(weights.data),
          fmt::format("a number of the {}s is not finite", what));
  const auto is_vertex = [V](int v) { return v >= 0 && v < V; };
  require(begin.data.front() == 0 && static_cast<hsize_t>(begin.data.back()) == patch.rows,
          "the patches do not cover their table");
  std::vector<Site> sites;
  for (std::size_t s = 0; s < S; ++s) {
    Site site;
    site.vertex = vertex.data[s];
    site.direction = Eigen::Map<const Eigen::Vector3d>(direction.data.data() + 3 * s);
    site.full_load = full_load.data[s];
    const auto name = [&] { return fmt::format("{} {}", what, s); };
    const int first = begin.data[s], end = begin.data[s + 1];
    require(0 <= first && first < end && static_cast<hsize_t>(end) <= patch.rows,
            name() + " has no patch");
    site.patch.assign(patch.data.begin() + first, patch.data.begin() + end);
    site.weights.assign(weights.data.begin() + first, weights.data.begin() + end);
    double sum = 0;
    for (std::size_t k = 0; k < site.patch.size(); ++k) {
      require(is_vertex(site.patch[k]), name() + " has a patch off the surface");
      require(site.weights[k] >= 0.0f, name() + " has a negative weight");
      sum += site.weights[k];
    }
    require(is_vertex(site.vertex) && site.patch.front() == site.vertex,
            name() + " does not lie in its own patch");
    require(std::abs(sum - 1.0) < 1e-3, "the weights of " + name() + " do not sum to 1");
    require(std::abs(site.direction.norm() - 1.0) < 1e-6,
            "the load direction of " + name() + " is not a unit vector");
    require(site.full_load > 0.0, name() + " has no load");
    sites.push_back(std::move(site));
  }
  return sites;
}

void read_sites(hid_t file, ReducedBody& body) {
  const Handle g = open_group(file, "sites");
  body.sites = read_loaded_places(g, body.surface.vertex_count(), "site");
  const auto S = static_cast<hsize_t>(body.sites.size());
  const Table<double> depth = read_table<double>(g, "press_depth");
  require(depth.rows == S, "press_depth does not have one row per site");
  require(all_finite(depth.data), "a press depth is not finite");
  body.press_depth = as_matrix<Eigen::MatrixXd>(depth);
  for (std::size_t s = 0; s < S; ++s) {
    const auto column = body.press_depth.col(static_cast<Eigen::Index>(s));
    require(column.size() >= 2 && column[0] == 0.0 && increases_strictly(column),
            fmt::format("the press depth of site {} does not grow with the load", s));
  }
  for (const auto& [name, slopes] : {std::pair{"depth_slope", &ReducedBody::depth_slope},
                                     std::pair{"level_slope", &ReducedBody::level_slope}}) {
    const Table<double> table = read_table<double>(g, name, S, depth.columns);
    require(all_finite(table.data), fmt::format("'{}' is not a number somewhere", name));
    body.*slopes = as_matrix<Eigen::MatrixXd>(table);
  }
}

// Checks that the press increases: a cubic between two increasing samples does if its slopes there
// are at least 0 and at most three times that of the secant.
void check_press(const ReducedBody& body) {
  const Eigen::VectorXd& levels = body.levels();
  constexpr double kRounding = 1 + 1e-9;
  for (Eigen::Index s = 0; s < body.press_depth.cols(); ++s) {
    for (Eigen::Index k = 0; k + 1 < levels.size(); ++k) {
      const double rise = body.press_depth(k + 1, s) - body.press_depth(k, s);
      const double run = levels[k + 1] - levels[k];
      for (const Eigen::Index end : {k, k + 1}) {
        const double depth = body.depth_slope(end, s), level = body.level_slope(end, s);
        require(depth >= 0 && depth * run <= 3 * rise * kRounding && level >= 0 &&
                    level * rise <= 3 * run * kRounding,
                fmt::format("between samples the press of site {} does not grow", s));
      }
    }
  }
}

bool same_axes(const SeparatedField& a, const SeparatedField& b) {
  if (a.axes().size() != b.axes().size()) return false;
  for (std::size_t j = 0; j < a.axes().size(); ++j) {
    if (a.axes()[j].name != b.axes()[j].name || a.axes()[j].samples != b.axes()[j].samples) {
      return false;
    }
  }
  return true;
}

void read_further(hid_t file, ReducedBody& body) {
  const Handle g = open_group(file, "parameters");
  const double count = read_number(g, "count");
  require(count == static_cast<double>(body.displacement.axes().size()) - 2,
          "the parameters are not those of the fields");
  hsize_t K = 1;
  for (int j = 0; j < static_cast<int>(count); ++j) {
    const Handle one = open_group(g, fmt::format("{}", j).c_str());
    const ParameterAxis& axis = body.displacement.axes()[j + 2];
    FurtherParameter p{read_text(one, "name"), axis.samples, read_number(one, "value")};
    const Table<double> samples =
        read_table<double>(one, "samples", static_cast<hsize_t>(axis.samples.size()), 1);
    require(p.name == axis.name && p.value >= samples.data.front() &&
                p.value <= samples.data.back() &&
                std::equal(samples.data.begin(), samples.data.end(), axis.samples.data()),
            fmt::format("the parameter '{}' is not that of the fields", p.name));
    body.further.push_back(std::move(p));
    K *= samples.rows;
    require(K <= hdf5::kLargestCount, "there are too many values of further parameters");
  }
  const auto S = static_cast<hsize_t>(body.sites.size());
  const auto L = static_cast<hsize_t>(body.press_depth.rows());
  const Table<double> depth = read_table<double>(g, "press_depth", S * K, L);
  const Table<double> load = read_table<double>(g, "full_load", K, S);
  require(all_finite(depth.data) && all_finite(load.data), "a depth or load is not a number");
  body.further_press_depth = as_matrix<Eigen::MatrixXd>(depth);
  body.further_full_load = as_matrix<Eigen::MatrixXd>(load);
  require(body.further_full_load.minCoeff() > 0, "a site has no load");
  for (const auto column : body.further_press_depth.colwise()) {
    require(column[0] == 0.0 && increases_strictly(column), "a press depth does not grow");
  }
}

void read_volume(hid_t file, ReducedBody& body) {
  const Handle g = open_group(file, "volume");
  const Table<double> nodes = read_table<double>(g, "nodes");
  const Table<int> tets = read_table<int>(g, "tets");
  require(nodes.columns == 3 && all_finite(nodes.data), "a node of the volume is not a point");
  require(tets.columns == 4 || tets.columns == 10, "the volume's elements are no tetrahedra");
  for (const int node : tets.data) {
    require(node >= 0 && static_cast<hsize_t>(node) < nodes.rows, "an element has no such node");
  }
  double rounding = 0;
  BodyVolume volume{as_matrix<Eigen::Matrix3Xd>(nodes),
                    as_matrix<Eigen::MatrixXi>(tets),
                    read_field(g, "displacement", 3 * nodes.rows, rounding),
                    {}};
  if (has_link(g, "stress")) volume.stress = read_field(g, "stress", 6 * nodes.rows, rounding);
  require(same_axes(volume.displacement, body.displacement) &&
              (!volume.stress || same_axes(*volume.stress, body.displacement)),
          "the volume depends on other parameters than the surface");
  body.volume = std::move(volume);
}

void read_several(hid_t file, ReducedBody& body) {
  const Handle g = open_group(file, "several_loads");
  // With more modes Newton's method would be too slow for the frame loop: at 64 the quartic
  // coefficients take 35 MB in memory.
  constexpr hsize_t kMostModes = 64;
  const Table<float> modes = read_table<float>(g, "modes");
  const auto V = static_cast<hsize_t>(body.surface.vertex_count());
  require(modes.rows >= 1 && modes.rows <= kMostModes && modes.columns == 3 * V,
          "the modes of several loads are not those of this surface");
  const auto n = static_cast<int>(modes.rows);
  const auto column = [&](const char* name, int order) -> Eigen::VectorXd {
    const auto rows = static_cast<hsize_t>(distinct_count(n, order));
    const Table<double> table = read_table<double>(g, name, rows, 1);
    require(all_finite(table.data), fmt::format("'{}' is not a number somewhere", name));
    return Eigen::Map<const Eigen::VectorXd>(table.data.data(), static_cast<Eigen::Index>(rows));
  };
  SeveralLoads several{
      energy_of(n, {column("quadratic", 2), column("cubic", 3), column("quartic", 4)}),
      as_matrix<Eigen::MatrixXf>(modes)};
  require(several.modes.allFinite(), "a mode of several loads is not a number somewhere");
  Eigen::MatrixXd K(n, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::Index i = 0; i < n; ++i) K(i, j) = several.energy.K[pair_row(i, j)];
  }
  require(K.llt().info() == Eigen::Success,
          "the stiffness of several loads is not positive definite");
  if (has_link(g, "reactions")) {
    several.reactions =
        read_loaded_places(open_group(g, "reactions"), body.surface.vertex_count(), "reaction");
  }
  const double checked = read_number(g, "checked");
  several.error_median = read_number(g, "error_median");
  several.error_worst = read_number(g, "error_worst");
  require(checked >= 0 && checked <= 1e6 && std::isfinite(several.error_worst) &&
              0 <= several.error_median && several.error_median <= several.error_worst,
          "the error of several loads is not valid");
  several.checked = static_cast<int>(checked);
  require(body.is_settled(), "several loads do not go with further parameters");
  body.several = std::move(several);
}

void check_axes(const ReducedBody& body) {
  const auto S = static_cast<Eigen::Index>(body.sites.size());
  for (const SeparatedField* field : {&body.displacement, &body.stress}) {
    const ParameterAxis& site = field->axes()[0];
    const ParameterAxis& level = field->axes()[1];
    require(site.samples.size() == S &&
                site.samples == Eigen::VectorXd::LinSpaced(S, 0.0, static_cast<double>(S - 1)),
            "the site axis does not number the sites");
    require(level.samples.size() == body.press_depth.rows() && level.samples.size() >= 2 &&
                level.samples[0] == 0.0 && level.samples[level.samples.size() - 1] == 1.0,
            "the level axis does not run from 0 to 1 in the steps of press_depth");
  }
  require(same_axes(body.displacement, body.stress),
          "displacement and stress depend on different parameters");
}

template <class T>
bool are_errors(const std::vector<T>& values) {  // finite, and none negative
  return all_finite(values) &&
         std::none_of(values.begin(), values.end(), [](T v) { return v < T{0}; });
}

std::optional<ErrorCourse> read_course(hid_t file, const char* name, const ReducedBody& body) {
  if (!has_link(file, name)) return std::nullopt;
  const Handle g = open_group(file, name);
  const Table<int> modes = read_table<int>(g, "modes");
  const Table<double> pooled = read_table<double>(g, "pooled", modes.rows, 1);
  const Table<float> snapshots = read_table<float>(g, "snapshots");
  const auto one_point = static_cast<hsize_t>(body.levels().size() - 1) * body.sites.size();
  require(modes.columns == 1 && modes.rows >= 1 && snapshots.rows == modes.rows &&
              snapshots.columns >= one_point && snapshots.columns % one_point == 0,
          fmt::format("'{}' is not of this body's snapshots", name));
  require(are_errors(pooled.data) && are_errors(snapshots.data),
          fmt::format("an error of '{}' is not valid", name));
  ErrorCourse course{as_matrix<Eigen::VectorXi>(Table<int>{modes.data, 1, modes.rows}),
                     as_matrix<Eigen::VectorXd>(Table<double>{pooled.data, 1, pooled.rows}),
                     as_matrix<Eigen::MatrixXf>(snapshots)};
  require(course.modes[0] >= 1 && increases_strictly(course.modes),
          fmt::format("the numbers of modes of '{}' do not increase", name));
  return course;
}

HeldOutRecord read_held_out(hid_t file, const ReducedBody& body) {
  const Handle g = open_group(file, "held_out");
  const auto S = static_cast<hsize_t>(body.sites.size());
  const Table<double> levels = read_table<double>(g, "levels");
  require(levels.rows >= 1 && levels.columns == 1 && all_finite(levels.data),
          "the held-out levels are not valid");
  const Table<float> moved = read_table<float>(g, "displacement", S, levels.rows);
  const Table<float> stressed = read_table<float>(g, "von_mises", S, levels.rows);
  HeldOutRecord record{as_matrix<Eigen::VectorXd>(Table<double>{levels.data, 1, levels.rows}),
                       as_matrix<Eigen::MatrixXf>(moved), read_number(g, "displacement_pooled"),
                       as_matrix<Eigen::MatrixXf>(stressed)};
  require(increases_strictly(record.levels), "the held-out levels do not increase");
  require(are_errors(moved.data) && are_errors(stressed.data) && record.displacement_pooled >= 0 &&
              std::isfinite(record.displacement_pooled),
          "an error of 'held_out' is not valid");
  return record;
}

// Files that are older than the attribute "method" name the method in the first word of a line of
// the provenance, or nowhere.
std::string method_of_old_file(const ReducedBody& body) {
  const std::string& reduction = body.provenance.reduction;
  return reduction.substr(0, reduction.find(' '));
}

}  // namespace

Provenance read_provenance(hid_t file) {
  const Handle g = open_group(file, "provenance");
  if (has(g, "json")) {
    Result<Provenance> provenance = provenance_of_json(read_text(g, "json"));
    if (!provenance.ok()) throw hdf5::Trouble{provenance.problem().message};
    return std::move(provenance).value();
  }
  const double count = read_number(g, "count");
  require(count >= 0 && count < 1000, "the provenance is damaged");
  std::vector<std::pair<std::string, std::string>> lines;
  for (int i = 0; i < static_cast<int>(count); ++i) {
    lines.emplace_back(read_text(g, fmt::format("{:03}_key", i).c_str()),
                       read_text(g, fmt::format("{:03}_value", i).c_str()));
  }
  return provenance_of_lines(lines);
}

ReducedBody read_content(hid_t file) {
  // A body cannot exist without its fields, so they start as one zero mode and are replaced below.
  const auto nothing = [](Eigen::Index rows) {
    ParameterAxis axis{"", Eigen::VectorXd::Zero(1), Eigen::MatrixXd::Zero(1, 1),
                       Between::kNothing};
    return SeparatedField(Eigen::MatrixXf::Zero(rows, 1), {axis});
  };
  ReducedBody body{.name = read_text(file, "name"),
                   .surface = {},
                   .fixed = {},
                   .sites = {},
                   .displacement = nothing(3),
                   .stress = nothing(6),
                   .press_depth = {},
                   .largest_von_mises = read_number(file, "largest_von_mises"),
                   .error = {},
                   .material = read_text(file, "material")};
  require(std::isfinite(body.largest_von_mises) && body.largest_von_mises >= 0.0,
          "largest_von_mises is not a stress");
  read_surface(file, body);
  read_sites(file, body);
  const auto V = static_cast<hsize_t>(body.surface.vertex_count());
  body.displacement = read_field(file, "displacement", 3 * V, body.error.displacement_rounding);
  body.stress = read_field(file, "stress", 6 * V, body.error.stress_rounding);
  check_axes(body);
  check_press(body);
  if (!body.is_settled()) read_further(file, body);
  if (has_link(file, "volume")) read_volume(file, body);
  if (has_link(file, "several_loads")) read_several(file, body);
  {
    const Handle g = open_group(file, "error");
    body.error.displacement_pooled = read_number(g, "displacement_pooled");
    body.error.displacement_worst = read_number(g, "displacement_worst");
    body.error.stress_pooled = read_number(g, "stress_pooled");
    body.error.stress_worst = read_number(g, "stress_worst");
    if (has(g, "between_sites")) body.error.between_sites = read_number(g, "between_sites");
    body.error.displacement_course = read_course(g, "displacement_course", body);
    body.error.stress_course = read_course(g, "stress_course", body);
    body.error.von_mises_course = read_course(g, "von_mises_course", body);
    if (has_link(g, "held_out")) body.error.held_out = read_held_out(g, body);
  }
  body.provenance = read_provenance(file);
  body.method = has(file, "method") ? read_text(file, "method") : method_of_old_file(body);
  return body;
}

}  // namespace palpable::body_file

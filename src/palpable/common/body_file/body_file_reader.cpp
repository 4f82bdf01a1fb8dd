#include "palpable/common/body_file/body_file_groups.h"
#include "palpable/common/reduced/body_check.h"

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
  require(samples.columns == 1, "an axis has no samples");
  axis.samples = Eigen::Map<const Eigen::VectorXd>(samples.data.data(),
                                                   static_cast<Eigen::Index>(samples.rows));
  axis.functions = as_matrix<Eigen::MatrixXd>(read_table<double>(g, "functions", m, samples.rows));
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
  rounding = read_number(group, "rounding");
  require(rounding >= 0 && std::isfinite(rounding), "the error of rounding is not valid");
  const double count = read_number(group, "axes");
  require(count >= 2 && count <= SeparatedField::kMostAxes,
          fmt::format("'{}' does not depend on site and level", name));
  std::vector<ParameterAxis> axes;
  for (int j = 0; j < static_cast<int>(count); ++j) {
    axes.push_back(read_axis(group, j, static_cast<hsize_t>(modes.cols())));
  }
  const std::string trouble =
      trouble_of_field(modes, axes, static_cast<Eigen::Index>(value_count), name);
  require(trouble.empty(), trouble);
  return {std::move(modes), std::move(axes)};
}

void read_surface(hid_t file, ReducedBody& body) {
  const Handle g = open_group(file, "surface");
  const Table<double> vertices = read_table<double>(g, "vertices");
  const Table<int> triangles = read_table<int>(g, "triangles");
  require(vertices.columns == 3, "the surface's vertices do not have three coordinates");
  require(triangles.columns == 3, "the surface's triangles do not have three corners");
  body.surface.vertices = as_matrix<Eigen::Matrix3Xd>(vertices);
  body.surface.triangles = as_matrix<Eigen::Matrix3Xi>(triangles);
  body.fixed = read_table<std::uint8_t>(g, "fixed", vertices.rows, 1).data;
}

// @param what  "site" or "reaction", for messages
std::vector<Site> read_loaded_places(hid_t g, const char* what) {
  const Table<int> vertex = read_table<int>(g, "vertex");
  const hsize_t S = vertex.rows;
  require(S >= 1 && vertex.columns == 1, fmt::format("the body has no {}", what));
  const Table<double> direction = read_table<double>(g, "direction", S, 3);
  const Table<double> full_load = read_table<double>(g, "full_load", S, 1);
  const Table<int> begin = read_table<int>(g, "patch_begin", S + 1, 1);
  const Table<int> patch = read_table<int>(g, "patch");
  const Table<float> weights = read_table<float>(g, "patch_weights", patch.rows, 1);
  require(begin.data.front() == 0 && static_cast<hsize_t>(begin.data.back()) == patch.rows,
          "the patches do not cover their table");
  std::vector<Site> sites;
  for (std::size_t s = 0; s < S; ++s) {
    Site site;
    site.vertex = vertex.data[s];
    site.direction = Eigen::Map<const Eigen::Vector3d>(direction.data.data() + 3 * s);
    site.full_load = full_load.data[s];
    const int first = begin.data[s], end = begin.data[s + 1];
    require(0 <= first && first < end && static_cast<hsize_t>(end) <= patch.rows,
            fmt::format("{} {} has no patch", what, s));
    site.patch.assign(patch.data.begin() + first, patch.data.begin() + end);
    site.weights.assign(weights.data.begin() + first, weights.data.begin() + end);
    sites.push_back(std::move(site));
  }
  return sites;
}

void read_sites(hid_t file, ReducedBody& body) {
  const Handle g = open_group(file, "sites");
  body.sites = read_loaded_places(g, "site");
  const auto S = static_cast<hsize_t>(body.sites.size());
  const Table<double> depth = read_table<double>(g, "press_depth");
  require(depth.rows == S, "press_depth does not have one row per site");
  body.press_depth = as_matrix<Eigen::MatrixXd>(depth);
  for (const auto& [name, slopes] : {std::pair{"depth_slope", &ReducedBody::depth_slope},
                                     std::pair{"level_slope", &ReducedBody::level_slope}}) {
    body.*slopes = as_matrix<Eigen::MatrixXd>(read_table<double>(g, name, S, depth.columns));
  }
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
    const Table<double> samples =
        read_table<double>(one, "samples", static_cast<hsize_t>(axis.samples.size()), 1);
    FurtherParameter p{read_text(one, "name"), axis.samples, read_number(one, "value")};
    std::copy(samples.data.begin(), samples.data.end(), p.samples.data());
    body.further.push_back(std::move(p));
    K *= samples.rows;
    require(K <= hdf5::kLargestCount, "there are too many values of further parameters");
  }
  const auto S = static_cast<hsize_t>(body.sites.size());
  const auto L = static_cast<hsize_t>(body.press_depth.rows());
  body.further_press_depth =
      as_matrix<Eigen::MatrixXd>(read_table<double>(g, "press_depth", S * K, L));
  body.further_full_load = as_matrix<Eigen::MatrixXd>(read_table<double>(g, "full_load", K, S));
}

void read_volume(hid_t file, ReducedBody& body) {
  const Handle g = open_group(file, "volume");
  const Table<double> nodes = read_table<double>(g, "nodes");
  const Table<int> tets = read_table<int>(g, "tets");
  require(nodes.columns == 3, "a node of the volume is not a point");
  double rounding = 0;
  BodyVolume volume{as_matrix<Eigen::Matrix3Xd>(nodes),
                    as_matrix<Eigen::MatrixXi>(tets),
                    read_field(g, "displacement", 3 * nodes.rows, rounding),
                    {}};
  if (has_link(g, "stress")) volume.stress = read_field(g, "stress", 6 * nodes.rows, rounding);
  body.volume = std::move(volume);
}

void read_several(hid_t file, ReducedBody& body) {
  const Handle g = open_group(file, "several_loads");
  const Table<float> modes = read_table<float>(g, "modes");
  const auto V = static_cast<hsize_t>(body.surface.vertex_count());
  require(modes.rows >= 1 && modes.rows <= hsize_t{kMostSeveralModes} && modes.columns == 3 * V,
          "the modes of several loads are not those of this surface");
  const auto n = static_cast<int>(modes.rows);
  const auto column = [&](const char* name, int order) -> Eigen::VectorXd {
    const auto rows = static_cast<hsize_t>(distinct_count(n, order));
    const Table<double> table = read_table<double>(g, name, rows, 1);
    return Eigen::Map<const Eigen::VectorXd>(table.data.data(), static_cast<Eigen::Index>(rows));
  };
  SeveralLoads several{
      energy_of(n, {column("quadratic", 2), column("cubic", 3), column("quartic", 4)}),
      as_matrix<Eigen::MatrixXf>(modes)};
  if (has_link(g, "reactions")) {
    several.reactions = read_loaded_places(open_group(g, "reactions"), "reaction");
  }
  const double checked = read_number(g, "checked");
  several.error_median = read_number(g, "error_median");
  several.error_worst = read_number(g, "error_worst");
  require(checked >= 0 && checked <= 1e6, "the error of several loads is not valid");
  several.checked = static_cast<int>(checked);
  body.several = std::move(several);
}

std::optional<ErrorCourse> read_course(hid_t file, const char* name) {
  if (!has_link(file, name)) return std::nullopt;
  const Handle g = open_group(file, name);
  const Table<int> modes = read_table<int>(g, "modes");
  const Table<double> pooled = read_table<double>(g, "pooled", modes.rows, 1);
  const Table<float> snapshots = read_table<float>(g, "snapshots");
  require(modes.columns == 1 && snapshots.rows == modes.rows,
          fmt::format("'{}' is not of this body's snapshots", name));
  return ErrorCourse{as_matrix<Eigen::VectorXi>(Table<int>{modes.data, 1, modes.rows}),
                     as_matrix<Eigen::VectorXd>(Table<double>{pooled.data, 1, pooled.rows}),
                     as_matrix<Eigen::MatrixXf>(snapshots)};
}

HeldOutRecord read_held_out(hid_t file, const ReducedBody& body) {
  const Handle g = open_group(file, "held_out");
  const auto S = static_cast<hsize_t>(body.sites.size());
  const Table<double> levels = read_table<double>(g, "levels");
  require(levels.columns == 1, "the held-out levels are not valid");
  const Table<float> moved = read_table<float>(g, "displacement", S, levels.rows);
  const Table<float> stressed = read_table<float>(g, "von_mises", S, levels.rows);
  return {as_matrix<Eigen::VectorXd>(Table<double>{levels.data, 1, levels.rows}),
          as_matrix<Eigen::MatrixXf>(moved), read_number(g, "displacement_pooled"),
          as_matrix<Eigen::MatrixXf>(stressed)};
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
  read_surface(file, body);
  read_sites(file, body);
  const auto V = static_cast<hsize_t>(body.surface.vertex_count());
  body.displacement = read_field(file, "displacement", 3 * V, body.error.displacement_rounding);
  body.stress = read_field(file, "stress", 6 * V, body.error.stress_rounding);
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
    body.error.displacement_course = read_course(g, "displacement_course");
    body.error.stress_course = read_course(g, "stress_course");
    body.error.von_mises_course = read_course(g, "von_mises_course");
    if (has_link(g, "held_out")) body.error.held_out = read_held_out(g, body);
  }
  const std::string trouble = trouble_of(body);
  require(trouble.empty(), trouble);
  body.provenance = read_provenance(file);
  body.method = has(file, "method") ? read_text(file, "method") : method_of_old_file(body);
  return body;
}

}  // namespace palpable::body_file

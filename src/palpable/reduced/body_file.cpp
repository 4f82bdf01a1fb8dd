#include "palpable/reduced/body_file.h"

#include "palpable/base/contract.h"
#include "palpable/reduced/hdf5_tools.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <new>
#include <string_view>
#include <system_error>

namespace palpable {
namespace {

using hdf5::Handle;
using hdf5::make_group;
using hdf5::open_group;
using hdf5::read_number;
using hdf5::read_table;
using hdf5::read_text;
using hdf5::require;
using hdf5::Table;
using hdf5::Trouble;
using hdf5::write_number;
using hdf5::write_table;
using hdf5::write_text;

constexpr std::string_view kKind = "palpable body file";

void write_field(hid_t file, const char* name, const SeparatedField& field) {
  const Handle group = make_group(file, name);
  const auto m = static_cast<hsize_t>(field.mode_count());
  write_table(group, "modes", field.modes().data(), m, static_cast<hsize_t>(field.value_count()));
  int number = 0;
  for (const ParameterAxis& axis : field.axes()) {
    const Handle g = make_group(group, fmt::format("axis_{}", number++).c_str());
    write_text(g, "name", axis.name);
    write_text(g, "between", axis.between == Between::kSmooth ? "smooth" : "nothing");
    const auto n = static_cast<hsize_t>(axis.samples.size());
    write_table(g, "samples", axis.samples.data(), n, 1);
    write_table(g, "functions", axis.functions.data(), m, n);
  }
}

void write_all(hid_t file, const ReducedBody& body) {
  require(body.fixed.size() == static_cast<std::size_t>(body.surface.vertex_count()),
          "'fixed' does not have one value per vertex");
  require(body.press_depth.cols() == static_cast<Eigen::Index>(body.sites.size()),
          "'press_depth' does not have one column per site");
  write_text(file, "name", body.name);
  write_text(file, "material", body.material);
  write_number(file, "largest_von_mises", body.largest_von_mises);

  {
    const Handle g = make_group(file, "surface");
    const auto V = static_cast<hsize_t>(body.surface.vertex_count());
    write_table(g, "vertices", body.surface.vertices.data(), V, 3);
    write_table(g, "triangles", body.surface.triangles.data(),
                static_cast<hsize_t>(body.surface.triangle_count()), 3);
    write_table(g, "fixed", body.fixed.data(), V, 1);
  }
  {
    const Handle g = make_group(file, "sites");
    const auto S = static_cast<hsize_t>(body.sites.size());
    std::vector<int> vertex, patch_begin{0}, patch;
    std::vector<float> weights;
    std::vector<double> direction, full_load;
    for (const Site& site : body.sites) {
      vertex.push_back(site.vertex);
      require(site.weights.size() == site.patch.size(), "a patch needs one weight per vertex");
      patch.insert(patch.end(), site.patch.begin(), site.patch.end());
      weights.insert(weights.end(), site.weights.begin(), site.weights.end());
      patch_begin.push_back(static_cast<int>(patch.size()));
      for (int k = 0; k < 3; ++k) direction.push_back(site.direction[k]);
      full_load.push_back(site.full_load);
    }
    write_table(g, "vertex", vertex.data(), S, 1);
    write_table(g, "direction", direction.data(), S, 3);
    write_table(g, "full_load", full_load.data(), S, 1);
    write_table(g, "patch_begin", patch_begin.data(), S + 1, 1);
    write_table(g, "patch", patch.data(), patch.size(), 1);
    write_table(g, "patch_weights", weights.data(), weights.size(), 1);
    write_table(g, "press_depth", body.press_depth.data(), S,
                static_cast<hsize_t>(body.press_depth.rows()));
  }
  write_field(file, "displacement", body.displacement);
  write_field(file, "stress", body.stress);
  {
    const Handle g = make_group(file, "error");
    write_number(g, "displacement_pooled", body.error.displacement_pooled);
    write_number(g, "displacement_worst", body.error.displacement_worst);
    write_number(g, "stress_pooled", body.error.stress_pooled);
    write_number(g, "stress_worst", body.error.stress_worst);
  }
  {
    const Handle g = make_group(file, "provenance");
    write_number(g, "count", static_cast<double>(body.provenance.size()));
    int number = 0;
    for (const auto& [key, value] : body.provenance) {
      write_text(g, fmt::format("{:03}_key", number).c_str(), key);
      write_text(g, fmt::format("{:03}_value", number).c_str(), value);
      ++number;
    }
  }
}

// ---- reading ---------------------------------------------------------------------------------

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

ParameterAxis read_axis(hid_t field, int number, hsize_t m, const char* expected_name,
                        Between between) {
  const Handle g = open_group(field, fmt::format("axis_{}", number).c_str());
  ParameterAxis axis;
  axis.name = read_text(g, "name");
  require(axis.name == expected_name,
          fmt::format("axis {} is '{}' where '{}' is needed", number, axis.name, expected_name));
  const std::string text = read_text(g, "between");
  require(text == (between == Between::kSmooth ? "smooth" : "nothing"),
          fmt::format("axis '{}' is interpolated by '{}', which this program does not know",
                      axis.name, text));
  axis.between = between;
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

SeparatedField read_field(hid_t file, const char* name, hsize_t value_count) {
  const Handle group = open_group(file, name);
  const Table<float> modes = read_table<float>(group, "modes");
  require(modes.rows >= 1, fmt::format("'{}' has no modes", name));
  require(modes.columns == value_count,
          fmt::format("the modes of '{}' have {} values where the surface needs {}", name,
                      modes.columns, value_count));
  require(all_finite(modes.data), fmt::format("a mode of '{}' is not a number somewhere", name));
  std::vector<ParameterAxis> axes;
  axes.push_back(read_axis(group, 0, modes.rows, "site", Between::kNothing));
  axes.push_back(read_axis(group, 1, modes.rows, "level", Between::kSmooth));
  return {as_matrix<Eigen::MatrixXf>(modes), std::move(axes)};
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

void read_sites(hid_t file, ReducedBody& body) {
  const Handle g = open_group(file, "sites");
  const Table<int> vertex = read_table<int>(g, "vertex");
  const hsize_t S = vertex.rows;
  require(S >= 1 && vertex.columns == 1, "the body has no site");
  const Table<double> direction = read_table<double>(g, "direction", S, 3);
  const Table<double> full_load = read_table<double>(g, "full_load", S, 1);
  const Table<int> begin = read_table<int>(g, "patch_begin", S + 1, 1);
  const Table<int> patch = read_table<int>(g, "patch");
  const Table<float> weights = read_table<float>(g, "patch_weights", patch.rows, 1);
  const Table<double> depth = read_table<double>(g, "press_depth");
  require(depth.rows == S, "press_depth does not have one row per site");
  require(all_finite(direction.data) && all_finite(full_load.data) && all_finite(weights.data) &&
              all_finite(depth.data),
          "a number of the sites is not finite");
  const int V = body.surface.vertex_count();
  const auto is_vertex = [V](int v) { return v >= 0 && v < V; };
  require(begin.data.front() == 0 && static_cast<hsize_t>(begin.data.back()) == patch.rows,
          "the patches do not cover their table");
  for (std::size_t s = 0; s < S; ++s) {
    Site site;
    site.vertex = vertex.data[s];
    site.direction = Eigen::Map<const Eigen::Vector3d>(direction.data.data() + 3 * s);
    site.full_load = full_load.data[s];
    const int first = begin.data[s], end = begin.data[s + 1];
    require(0 <= first && first < end && static_cast<hsize_t>(end) <= patch.rows,
            fmt::format("site {} has no patch", s));
    site.patch.assign(patch.data.begin() + first, patch.data.begin() + end);
    site.weights.assign(weights.data.begin() + first, weights.data.begin() + end);
    double sum = 0;
    for (std::size_t k = 0; k < site.patch.size(); ++k) {
      require(is_vertex(site.patch[k]), fmt::format("site {} has a patch off the surface", s));
      require(site.weights[k] >= 0.0f, fmt::format("site {} has a negative weight", s));
      sum += site.weights[k];
    }
    require(is_vertex(site.vertex) && site.patch.front() == site.vertex,
            fmt::format("site {} does not lie in its own patch", s));
    require(std::abs(sum - 1.0) < 1e-3, fmt::format("the weights of site {} do not sum to 1", s));
    require(std::abs(site.direction.norm() - 1.0) < 1e-6,
            fmt::format("the load direction of site {} is not a unit vector", s));
    require(site.full_load > 0.0, fmt::format("site {} has no load", s));
    body.sites.push_back(std::move(site));
  }
  body.press_depth = as_matrix<Eigen::MatrixXd>(depth);
  for (std::size_t s = 0; s < S; ++s) {
    const auto column = body.press_depth.col(static_cast<Eigen::Index>(s));
    require(column.size() >= 2 && column[0] == 0.0 && increases_strictly(column),
            fmt::format("the press depth of site {} does not grow with the load", s));
  }
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
}

ReducedBody read_all(hid_t file) {
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
                   .material = read_text(file, "material"),
                   .provenance = {}};
  require(std::isfinite(body.largest_von_mises) && body.largest_von_mises >= 0.0,
          "largest_von_mises is not a stress");
  read_surface(file, body);
  read_sites(file, body);
  const auto V = static_cast<hsize_t>(body.surface.vertex_count());
  body.displacement = read_field(file, "displacement", 3 * V);
  body.stress = read_field(file, "stress", 6 * V);
  check_axes(body);
  {
    const Handle g = open_group(file, "error");
    body.error.displacement_pooled = read_number(g, "displacement_pooled");
    body.error.displacement_worst = read_number(g, "displacement_worst");
    body.error.stress_pooled = read_number(g, "stress_pooled");
    body.error.stress_worst = read_number(g, "stress_worst");
  }
  const Handle g = open_group(file, "provenance");
  const double count = read_number(g, "count");
  require(count >= 0 && count < 1000, "the provenance is damaged");
  for (int i = 0; i < static_cast<int>(count); ++i) {
    body.provenance.emplace_back(read_text(g, fmt::format("{:03}_key", i).c_str()),
                                 read_text(g, fmt::format("{:03}_value", i).c_str()));
  }
  return body;
}

ReducedBody from_bytes(const std::string& bytes) {
  const hdf5::Image image(bytes, kKind, kBodyFileVersion, "a body file of Palpable",
                          "bake the body again");
  return read_all(image.file());
}

}  // namespace

Result<ReducedBody> read_body_file(const std::filesystem::path& path) {
  std::error_code code;
  if (!std::filesystem::exists(path, code)) {
    return Problem{
        fmt::format("{}: no such body file; make one with 'palpable bake'", path.string())};
  }
  if (!std::filesystem::is_regular_file(path, code)) {
    return Problem{fmt::format("{}: not a file", path.string())};
  }
  const hdf5::Quiet quiet;
  try {
    return from_bytes(hdf5::all_bytes(path));
  } catch (const Trouble& trouble) {
    return Problem{fmt::format("{}: {}", path.string(), trouble.what)};
  } catch (const std::bad_alloc&) {
    return Problem{fmt::format("{}: needs more memory than there is", path.string())};
  }
}

void write_body_file(const std::filesystem::path& path, const ReducedBody& body) {
  const hdf5::Quiet quiet;
  try {
    const std::string bytes =
        hdf5::image_of(kKind, kBodyFileVersion, [&](hid_t file) { write_all(file, body); });
    (void)from_bytes(bytes);  // a body that breaks a promise of reduced_body.h is not written
    hdf5::write_durably(path, bytes);
  } catch (const Trouble& trouble) {
    throw Error(fmt::format("{}: {}", path.string(), trouble.what));
  }
}

}  // namespace palpable

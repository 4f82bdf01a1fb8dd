#include "palpable/common/body_file/touch_groups.h"

#include "palpable/common/base/error.h"
#include "palpable/common/base/row_kernels.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

namespace palpable {
namespace {

using hdf5::read_table;
using hdf5::require;
using hdf5::Table;
using hdf5::write_table;

// A dataset of one column.
template <class T>
void write_column(hid_t group, const std::string& name, const std::vector<T>& values) {
  write_table(group, name.c_str(), values.data(), values.size(), 1);
}

template <class T>
std::vector<T> read_column(hid_t group, const std::string& name) {
  Table<T> table = read_table<T>(group, name.c_str());
  require(table.columns == 1, fmt::format("dataset '{}' is not one column", name));
  return std::move(table.data);
}

template <class T>
std::vector<T> read_column(hid_t group, const std::string& name, std::size_t rows) {
  return read_table<T>(group, name.c_str(), rows, 1).data;
}

int read_count(hid_t group, const char* name) {
  const double value = hdf5::read_number(group, name);
  require(value >= 0 && value <= 1e9 && value == std::floor(value),
          fmt::format("attribute '{}' is not a count", name));
  return static_cast<int>(value);
}

// NAME: rows x width in 16 bits, NAME_scale: a factor for each row.
void write_rows(hid_t group, const std::string& name, const RoundedRows& rows) {
  write_table(group, name.c_str(), rows.values.data(), rows.scale.size(), rows.width);
  write_column(group, name + "_scale", rows.scale);
}

RoundedRows read_rows(hid_t group, const std::string& name) {
  Table<std::int16_t> values = read_table<std::int16_t>(group, name.c_str());
  RoundedRows rows{values.columns, std::move(values.data), {}};
  rows.scale = read_column<float>(group, name + "_scale", values.rows);
  return rows;
}

// NAME: the distinct coefficients in 16 bits, NAME_scale: a factor for each run.
void write_form(hid_t group, const std::string& name, const SymmetricForm& form) {
  write_column(group, name, form.values);
  write_column(group, name + "_scale", form.scale);
}

SymmetricForm read_form(hid_t group, const std::string& name, int variables, int degree) {
  require(variables <= kMostTouchModes,
          fmt::format("'{}' is of {} modes, more than {}", name, variables, kMostTouchModes));
  SymmetricForm form{variables, degree, {}, {}};
  form.values = read_column<std::int16_t>(group, name, distinct_coefficients(variables, degree));
  form.scale = read_column<float>(group, name + "_scale", runs_of(variables, degree));
  return form;
}

Eigen::Matrix3Xd read_points(hid_t group, const char* name) {
  const Table<double> table = read_table<double>(group, name);
  require(table.columns == 3, fmt::format("dataset '{}' does not have three columns", name));
  return Eigen::Map<const Eigen::Matrix3Xd>(table.data.data(), 3,
                                            static_cast<Eigen::Index>(table.rows));
}

}  // namespace

void write_group(hid_t group, const CoarseSkin& skin) {
  const SurfaceMesh& surface = skin.surface;
  write_table(group, "vertices", surface.vertices.data(),
              static_cast<hsize_t>(surface.vertex_count()), 3);
  write_table(group, "triangles", surface.triangles.data(),
              static_cast<hsize_t>(surface.triangle_count()), 3);
  write_column(group, "fixed", skin.fixed);
}

void read_group(hid_t group, CoarseSkin& skin) {
  skin.surface.vertices = read_points(group, "vertices");
  const Table<int> triangles = read_table<int>(group, "triangles");
  require(triangles.columns == 3, "dataset 'triangles' does not have three columns");
  skin.surface.triangles = Eigen::Map<const Eigen::Matrix3Xi>(
      triangles.data.data(), 3, static_cast<Eigen::Index>(triangles.rows));
  skin.fixed = read_column<std::uint8_t>(group, "fixed",
                                         static_cast<std::size_t>(skin.surface.vertex_count()));
}

void write_group(hid_t group, const ComplianceTable& table) {
  hdf5::write_number(group, "clusters", table.clusters);
  write_column(group, "cluster_of", table.cluster_of);
  write_rows(group, "basis", table.basis);
  write_rows(group, "beyond", table.beyond);
  write_column(group, "far_first", table.far_first);
  write_column(group, "far_second", table.far_second);
  write_rows(group, "couplings", table.couplings);
  write_column(group, "first", table.first);
  write_column(group, "neighbours", table.neighbours);
  write_table(group, "near", table.near.data(), table.near.size() / kRowStep, kRowStep);
  write_column(group, "near_scale", table.near_scale);
}

void read_group(hid_t group, ComplianceTable& table) {
  table.clusters = read_count(group, "clusters");
  table.cluster_of = read_column<int>(group, "cluster_of");
  table.basis = read_rows(group, "basis");
  table.beyond = read_rows(group, "beyond");
  table.far_first = read_column<int>(group, "far_first");
  table.far_second = read_column<int>(group, "far_second", table.far_first.size());
  table.couplings = read_rows(group, "couplings");
  table.first = read_column<int>(group, "first");
  require(!table.first.empty(), "dataset 'first' is empty");
  table.vertices = static_cast<int>(table.first.size()) - 1;
  table.neighbours = read_column<int>(group, "neighbours");
  Table<std::int16_t> near = read_table<std::int16_t>(group, "near");
  require(near.columns == kRowStep, "the near field is not in rows of sixteen");
  table.near = std::move(near.data);
  table.near_scale = read_column<float>(group, "near_scale", table.first.size() - 1);
}

void write_group(hid_t group, const RegionTable& table) {
  hdf5::write_number(group, "vertex", table.vertex);
  hdf5::write_number(group, "leading", table.leading());
  write_column(group, "vertices", table.vertices);
  write_rows(group, "modes", table.modes);
  write_rows(group, "far_shapes", table.far_shapes);
  write_rows(group, "far_shares", table.far_shares);
  write_form(group, "cubic", table.cubic);
  write_form(group, "quartic", table.quartic);
}

void read_group(hid_t group, RegionTable& table) {
  table.vertex = read_count(group, "vertex");
  table.vertices = read_column<int>(group, "vertices");
  table.modes = read_rows(group, "modes");
  table.far_shapes = read_rows(group, "far_shapes");
  table.far_shares = read_rows(group, "far_shares");
  const auto r = static_cast<int>(table.modes.width);
  const int s = read_count(group, "leading");
  require(s <= std::min(r, kMostLeadingModes), "a region has too many leading modes");
  table.cubic = read_form(group, "cubic", r, 3);
  table.quartic = read_form(group, "quartic", s, 4);
}

void write_group(hid_t group, const CrossTable& table) {
  write_rows(group, "modes", table.modes);
  write_form(group, "cubic", table.cubic);
}

void read_group(hid_t group, CrossTable& table) {
  table.modes = read_rows(group, "modes");
  table.cubic = read_form(group, "cubic", static_cast<int>(table.modes.width), 3);
}

void write_group(hid_t group, const ShellTable& table) {
  const auto W = static_cast<hsize_t>(table.nodes());
  write_table(group, "stress_free", table.stress_free.data(), W, 3);
  write_table(group, "preload", table.preload.data(), W, 3);
  write_table(group, "elements", table.elements.data(), table.material_of.size(),
              static_cast<hsize_t>(table.element_nodes));
  write_column(group, "material_of", table.material_of);
  hdf5::write_number(group, "materials", static_cast<double>(table.materials.size()));
  int k = 0;
  for (const Material& material : table.materials) {
    hdf5::write_text(group, fmt::format("law_{}", k).c_str(), law_name(material));
    write_column(group, fmt::format("constants_{}", k++), constants_of(material));
  }
  write_column(group, "first", table.first);
  write_column(group, "points", table.points);
  write_column(group, "weights", table.weights);
}

void write_group(hid_t group, const std::vector<HeldOutTouch>& touches) {
  std::vector<int> things;
  std::vector<double> values;
  for (const HeldOutTouch& touch : touches) {
    things.push_back(static_cast<int>(touch.thing));
    for (const double HeldOutTouch::*value : kHeldOutValues) values.push_back(touch.*value);
  }
  write_column(group, "things", things);
  write_table(group, "values", values.data(), touches.size(), kHeldOutValues.size());
  // In a dataset of its own, so that programs older than this value can still read the file.
  const auto is_known = [](const HeldOutTouch& touch) { return touch.unscaled_error.has_value(); };
  if (touches.empty() || !std::all_of(touches.begin(), touches.end(), is_known)) return;
  std::vector<double> indicators;
  for (const HeldOutTouch& touch : touches) indicators.push_back(*touch.unscaled_error);
  write_column(group, "unscaled_error", indicators);
}

namespace {

Material read_material(hid_t group, int k) {
  const std::string law = hdf5::read_text(group, fmt::format("law_{}", k).c_str());
  const std::vector<double> constants = read_column<double>(group, fmt::format("constants_{}", k));
  try {
    require(constants.size() == law_constants(law).size(),
            fmt::format("law '{}' does not have {} constants", law, constants.size()));
    return material_from_constants(law, constants);
  } catch (const Error& error) { throw hdf5::Trouble{error.what()}; }
}

}  // namespace

void read_group(hid_t group, ShellTable& table) {
  table.stress_free = read_points(group, "stress_free");
  table.preload = read_points(group, "preload");
  Table<int> elements = read_table<int>(group, "elements");
  require(elements.columns == 4 || elements.columns == 10, "elements do not have 4 or 10 nodes");
  table.element_nodes = static_cast<int>(elements.columns);
  table.elements = std::move(elements.data);
  table.material_of = read_column<int>(group, "material_of", elements.rows);
  const int materials = read_count(group, "materials");
  require(materials <= kMostMaterials, "there are too many materials");
  for (int k = 0; k < materials; ++k) table.materials.push_back(read_material(group, k));
  table.first = read_column<int>(group, "first");
  require(!table.first.empty(), "dataset 'first' is empty");
  table.points = read_column<int>(group, "points");
  table.weights = read_column<float>(group, "weights", table.points.size());
}

void read_group(hid_t group, std::vector<HeldOutTouch>& touches) {
  const std::vector<int> things = read_column<int>(group, "things");
  const Table<double> values =
      read_table<double>(group, "values", things.size(), kHeldOutValues.size());
  touches.resize(things.size());
  const double* next = values.data.data();
  for (std::size_t k = 0; k < things.size(); ++k) {
    touches[k].thing = static_cast<PressingThing>(things[k]);
    for (double HeldOutTouch::*value : kHeldOutValues) touches[k].*value = *next++;
  }
  if (!hdf5::has_link(group, "unscaled_error")) return;
  const std::vector<double> indicators =
      read_column<double>(group, "unscaled_error", things.size());
  for (std::size_t k = 0; k < things.size(); ++k) touches[k].unscaled_error = indicators[k];
}

void write_group(hid_t group, const VibrationTable& table) {
  hdf5::write_number(group, "density", table.density);
  hdf5::write_number(group, "mass", table.mass);
  hdf5::write_number(group, "loss_factor", table.loss_factor);
  write_column(group, "omega", table.omega);
  write_table(group, "shapes", table.shapes.data(), static_cast<hsize_t>(table.shapes.cols()),
              static_cast<hsize_t>(table.shapes.rows()));
}

void read_group(hid_t group, VibrationTable& table) {
  table.density = hdf5::read_number(group, "density");
  table.mass = hdf5::read_number(group, "mass");
  table.loss_factor = hdf5::read_number(group, "loss_factor");
  table.omega = read_column<double>(group, "omega");
  const Table<float> shapes = read_table<float>(group, "shapes");
  require(shapes.columns == table.omega.size(), "shapes are not of as many modes as 'omega'");
  table.shapes = Eigen::Map<const Eigen::MatrixXf>(shapes.data.data(),
                                                   static_cast<Eigen::Index>(shapes.columns),
                                                   static_cast<Eigen::Index>(shapes.rows));
}

void write_group(hid_t group, const ModalTables& tables) {
  hdf5::write_number(group, "half_space", tables.half_space);
  if (tables.friction > 0) hdf5::write_number(group, "friction", tables.friction);
  hdf5::write_number(group, "point_spacing", tables.point_spacing);
  write_table(group, "inner_modes", tables.inner_modes.data(),
              static_cast<hsize_t>(tables.inner_modes.cols()),
              static_cast<hsize_t>(tables.inner_modes.rows()));
  write_group(hdf5::make_group(group, "shell"), tables.shell);
}

void read_group(hid_t group, ModalTables& tables) {
  tables.half_space = hdf5::read_number(group, "half_space");
  if (hdf5::has(group, "friction")) tables.friction = hdf5::read_number(group, "friction");
  tables.point_spacing = hdf5::read_number(group, "point_spacing");
  const Table<float> modes = read_table<float>(group, "inner_modes");
  tables.inner_modes =
      Eigen::Map<const Eigen::MatrixXf>(modes.data.data(), static_cast<Eigen::Index>(modes.columns),
                                        static_cast<Eigen::Index>(modes.rows));
  read_group(hdf5::open_group(group, "shell"), tables.shell);
}

}  // namespace palpable

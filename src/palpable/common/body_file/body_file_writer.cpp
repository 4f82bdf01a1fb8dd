#include "palpable/common/body_file/body_file_groups.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace palpable::body_file {
namespace {

using hdf5::Handle;
using hdf5::has;
using hdf5::make_group;
using hdf5::require;
using hdf5::write_number;
using hdf5::write_table;
using hdf5::write_text;

// Error from rounding the modes, over all samples of all axes together: relative L2.
double rounding_error(const SeparatedField& field, const Eigen::MatrixXf& rounded) {
  const std::vector<ParameterAxis>& axes = field.axes();
  // sum over samples of |F w|^2 = sum_ij (F^T F)_ij (W W^T)_ij, and W W^T is a product over axes.
  Eigen::MatrixXd weights = Eigen::MatrixXd::Ones(field.mode_count(), field.mode_count());
  for (const ParameterAxis& axis : axes) {
    weights.array() *= (axis.functions.transpose() * axis.functions).array();
  }
  const auto squared = [&](const Eigen::MatrixXf& F) {
    const Eigen::MatrixXd gram = (F.transpose() * F).cast<double>();
    return gram.cwiseProduct(weights).sum();
  };
  const double whole = squared(field.modes());
  return whole > 0 ? std::sqrt(std::max(0.0, squared(rounded - field.modes()) / whole)) : 0.0;
}

// Half precision spans 6e-5 to 65504 with 11 bits: each mode is scaled by a power of two so that
// its largest value lies in [1/2, 1) times 2^15.
Eigen::VectorXd half_scales(const Eigen::MatrixXf& modes) {
  Eigen::VectorXd scales(modes.cols());
  for (Eigen::Index i = 0; i < modes.cols(); ++i) {
    int exponent = 0;
    std::frexp(modes.col(i).cwiseAbs().maxCoeff(), &exponent);
    scales[i] = std::ldexp(1.0, exponent - 15);
  }
  return scales;
}

// @returns the field's rounding error, at least `lost_before`
double write_field(hid_t file, const char* name, const SeparatedField& field, ModeStorage storage,
                   double lost_before) {
  const Handle group = make_group(file, name);
  const auto m = static_cast<hsize_t>(field.mode_count());
  const auto N = static_cast<hsize_t>(field.value_count());
  double lost = 0;
  write_text(group, "form",
             field.largest_block() < field.mode_count() ? "modes of their own per site" : "global");
  if (storage == ModeStorage::kFloat16) {
    const Eigen::VectorXd scales = half_scales(field.modes());
    const Eigen::Matrix<Eigen::half, Eigen::Dynamic, Eigen::Dynamic> halves =
        (field.modes() * scales.cwiseInverse().cast<float>().asDiagonal()).cast<Eigen::half>();
    lost = rounding_error(field, halves.cast<float>() * scales.cast<float>().asDiagonal());
    write_table(group, "modes_float16", halves.data(), m, N);
    write_table(group, "mode_scale", scales.data(), m, 1);
  } else {
    write_table(group, "modes", field.modes().data(), m, N);
  }
  lost = std::max(lost, lost_before);  // a body that was read from a rounded file keeps its error
  write_number(group, "rounding", lost);
  write_number(group, "axes", static_cast<double>(field.axes().size()));
  int number = 0;
  for (const ParameterAxis& axis : field.axes()) {
    const Handle g = make_group(group, fmt::format("axis_{}", number++).c_str());
    write_text(g, "name", axis.name);
    write_text(g, "between", axis.between == Between::kSmooth ? kSpline : kNothing);
    const auto n = static_cast<hsize_t>(axis.samples.size());
    write_table(g, "samples", axis.samples.data(), n, 1);
    write_table(g, "functions", axis.functions.data(), m, n);
  }
  return lost;
}

void write_further(hid_t file, const ReducedBody& body) {
  const Handle g = make_group(file, "parameters");
  write_number(g, "count", static_cast<double>(body.further.size()));
  int number = 0;
  hsize_t K = 1;
  for (const FurtherParameter& p : body.further) {
    const Handle one = make_group(g, fmt::format("{}", number++).c_str());
    write_text(one, "name", p.name);
    write_number(one, "value", p.value);
    write_table(one, "samples", p.samples.data(), static_cast<hsize_t>(p.samples.size()), 1);
    K *= static_cast<hsize_t>(p.samples.size());
  }
  const auto S = static_cast<hsize_t>(body.sites.size());
  const auto L = static_cast<hsize_t>(body.levels().size());
  const auto fits = [](const Eigen::MatrixXd& table, hsize_t rows, hsize_t columns) {
    return table.rows() == static_cast<Eigen::Index>(rows) &&
           table.cols() == static_cast<Eigen::Index>(columns);
  };
  require(fits(body.further_press_depth, L, S * K) && fits(body.further_full_load, S, K),
          "press depth and load are not known at all values of the further parameters");
  write_table(g, "press_depth", body.further_press_depth.data(), S * K, L);
  write_table(g, "full_load", body.further_full_load.data(), K, S);
}

void write_volume(hid_t file, const BodyVolume& volume, ModeStorage storage,
                  const ReductionError& error) {
  const Handle g = make_group(file, "volume");
  write_table(g, "nodes", volume.nodes.data(), static_cast<hsize_t>(volume.nodes.cols()), 3);
  write_table(g, "tets", volume.tets.data(), static_cast<hsize_t>(volume.tets.cols()),
              static_cast<hsize_t>(volume.tets.rows()));
  write_field(g, "displacement", volume.displacement, storage, error.displacement_rounding);
  if (volume.stress) write_field(g, "stress", *volume.stress, storage, error.stress_rounding);
}

void write_course(hid_t file, const char* name, const std::optional<ErrorCourse>& course) {
  if (!course) return;
  const Handle g = make_group(file, name);
  const auto q = static_cast<hsize_t>(course->modes.size());
  require(course->pooled.size() == course->modes.size() &&
              course->snapshots.cols() == course->modes.size(),
          fmt::format("'{}' does not have one error for each number of modes", name));
  write_table(g, "modes", course->modes.data(), q, 1);
  write_table(g, "pooled", course->pooled.data(), q, 1);
  write_table(g, "snapshots", course->snapshots.data(), q,
              static_cast<hsize_t>(course->snapshots.rows()));
}

void write_held_out(hid_t file, const HeldOutRecord& held_out) {
  const Handle g = make_group(file, "held_out");
  const auto S = static_cast<hsize_t>(held_out.displacement.cols());
  const auto H = static_cast<hsize_t>(held_out.levels.size());
  for (const Eigen::MatrixXf* errors : {&held_out.displacement, &held_out.von_mises}) {
    require(
        errors->rows() == held_out.levels.size() && errors->cols() == held_out.displacement.cols(),
        "'held_out' does not have one error for each level and site");
  }
  write_table(g, "levels", held_out.levels.data(), H, 1);
  write_table(g, "displacement", held_out.displacement.data(), S, H);
  write_number(g, "displacement_pooled", held_out.displacement_pooled);
  write_table(g, "von_mises", held_out.von_mises.data(), S, H);
}

// Writes sites or reactions; all patches are in one table, one after the other.
void write_places(hid_t group, const std::vector<Site>& sites) {
  std::vector<int> vertex, patch_begin{0}, patch;
  std::vector<float> weights;
  std::vector<double> direction, full_load;
  for (const Site& site : sites) {
    vertex.push_back(site.vertex);
    require(site.weights.size() == site.patch.size(), "a patch needs one weight per vertex");
    patch.insert(patch.end(), site.patch.begin(), site.patch.end());
    weights.insert(weights.end(), site.weights.begin(), site.weights.end());
    patch_begin.push_back(static_cast<int>(patch.size()));
    for (int k = 0; k < 3; ++k) direction.push_back(site.direction[k]);
    full_load.push_back(site.full_load);
  }
  const auto S = static_cast<hsize_t>(sites.size());
  write_table(group, "vertex", vertex.data(), S, 1);
  write_table(group, "direction", direction.data(), S, 3);
  write_table(group, "full_load", full_load.data(), S, 1);
  write_table(group, "patch_begin", patch_begin.data(), S + 1, 1);
  write_table(group, "patch", patch.data(), patch.size(), 1);
  write_table(group, "patch_weights", weights.data(), weights.size(), 1);
}

void write_several(hid_t file, const SeveralLoads& several) {
  const auto n = static_cast<hsize_t>(several.mode_count());
  const Eigen::Index P = distinct_count(several.mode_count(), 2);
  require(several.modes.cols() == several.energy.modes() && several.energy.K.size() == P &&
              several.energy.C.rows() == P && several.energy.D.rows() == P &&
              several.energy.D.cols() == P,
          "the modes of several loads are not those of their energy");
  const Handle g = make_group(file, "several_loads");
  const DistinctCoefficients energy = distinct_coefficients(several.energy);
  const auto column = [&](const char* name, const Eigen::VectorXd& values) {
    write_table(g, name, values.data(), static_cast<hsize_t>(values.size()), 1);
  };
  column("quadratic", energy.quadratic);
  column("cubic", energy.cubic);
  column("quartic", energy.quartic);
  write_table(g, "modes", several.modes.data(), n, static_cast<hsize_t>(several.modes.rows()));
  write_number(g, "checked", several.checked);
  write_number(g, "error_median", several.error_median);
  write_number(g, "error_worst", several.error_worst);
  if (!several.reactions.empty()) write_places(make_group(g, "reactions"), several.reactions);
}

}  // namespace

void write_provenance(hid_t file, const Provenance& provenance) {
  const Handle g = make_group(file, "provenance");
  write_number(g, "count", 0);
  write_text(g, "json", json_of(provenance).dump());
}

void write_content(hid_t file, const ReducedBody& body, ModeStorage storage) {
  require(body.fixed.size() == static_cast<std::size_t>(body.surface.vertex_count()),
          "'fixed' does not have one value per vertex");
  require(body.press_depth.cols() == static_cast<Eigen::Index>(body.sites.size()),
          "'press_depth' does not have one column per site");
  require(body.depth_slope.size() == body.press_depth.size() &&
              body.level_slope.size() == body.press_depth.size(),
          "the slopes of the press are not tabulated");
  write_text(file, "name", body.name);
  write_text(file, "material", body.material);
  write_text(file, "method", body.method);
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
    write_places(g, body.sites);
    const auto L = static_cast<hsize_t>(body.press_depth.rows());
    write_text(g, "between", "nothing: the site is categorical, the nearest one counts");
    write_table(g, "press_depth", body.press_depth.data(), S, L);
    write_table(g, "depth_slope", body.depth_slope.data(), S, L);
    write_table(g, "level_slope", body.level_slope.data(), S, L);
  }
  write_field(file, "displacement", body.displacement, storage, body.error.displacement_rounding);
  write_field(file, "stress", body.stress, storage, body.error.stress_rounding);
  if (!body.is_settled()) write_further(file, body);
  if (body.volume) write_volume(file, *body.volume, storage, body.error);
  if (body.several) write_several(file, *body.several);
  {
    const Handle g = make_group(file, "error");
    write_number(g, "displacement_pooled", body.error.displacement_pooled);
    write_number(g, "displacement_worst", body.error.displacement_worst);
    write_number(g, "stress_pooled", body.error.stress_pooled);
    write_number(g, "stress_worst", body.error.stress_worst);
    if (body.error.between_sites) write_number(g, "between_sites", *body.error.between_sites);
    write_course(g, "displacement_course", body.error.displacement_course);
    write_course(g, "stress_course", body.error.stress_course);
    write_course(g, "von_mises_course", body.error.von_mises_course);
    if (body.error.held_out) write_held_out(g, *body.error.held_out);
  }
  write_provenance(file, body.provenance);
}

}  // namespace palpable::body_file

#include "palpable/common/reduced/body_check.h"

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace palpable {
namespace {

bool is_rising(const auto& values) {
  for (Eigen::Index i = 1; i < values.size(); ++i) {
    if (!(values[i - 1] < values[i])) return false;
  }
  return true;
}

// @param number  of the axis: 0 is the site, 1 the level
std::string trouble_of_axis(const ParameterAxis& axis, Eigen::Index number, Eigen::Index modes) {
  if (axis.samples.size() < 1) return "an axis has no samples";
  if (!axis.samples.allFinite()) return "an axis has samples that are not numbers";
  if (!is_rising(axis.samples)) {
    return fmt::format("the samples of axis '{}' do not increase", axis.name);
  }
  if (axis.functions.rows() != axis.samples.size() || axis.functions.cols() != modes) {
    return fmt::format("the functions of axis '{}' are not those of its samples and modes",
                       axis.name);
  }
  if (!axis.functions.allFinite()) return "a parameter function is not a number somewhere";
  const std::string needed = number == 0 ? "site" : number == 1 ? "level" : axis.name;
  if (axis.name != needed) {
    return fmt::format("axis {} is '{}' where '{}' is needed", number, axis.name, needed);
  }
  if ((axis.between == Between::kNothing) != (number == 0)) {
    return fmt::format("'{}' is {} quantity", needed, number == 0 ? "no" : "a");
  }
  return {};
}

std::string trouble_of_surface(const ReducedBody& body) {
  if (body.surface.vertex_count() < 4) return "the surface has too few vertices";
  if (!body.surface.vertices.allFinite()) return "a vertex is not a number";
  const WatertightReport report = check_watertight(body.surface);
  if (!report.watertight()) return "the surface is " + report.describe();
  if (std::ssize(body.fixed) != body.surface.vertex_count()) {
    return "'fixed' does not have one value per vertex";
  }
  return {};
}

// @param name  "site 3", for the line
std::string trouble_of_place(const Site& site, int V, const std::string& name) {
  const auto is_vertex = [V](int v) { return v >= 0 && v < V; };
  if (site.patch.empty()) return name + " has no patch";
  if (site.weights.size() != site.patch.size()) return name + " needs one weight per vertex";
  double sum = 0;
  for (std::size_t k = 0; k < site.patch.size(); ++k) {
    if (!is_vertex(site.patch[k])) return name + " has a patch off the surface";
    if (!(site.weights[k] >= 0.0f)) return name + " has a negative weight";
    sum += static_cast<double>(site.weights[k]);
  }
  if (!is_vertex(site.vertex) || site.patch.front() != site.vertex) {
    return name + " does not lie in its own patch";
  }
  if (!(std::abs(sum - 1.0) < 1e-3)) return "the weights of " + name + " do not sum to 1";
  if (!(std::abs(site.direction.norm() - 1.0) < 1e-6)) {
    return "the load direction of " + name + " is not a unit vector";
  }
  return site.full_load > 0.0 ? std::string() : name + " has no load";
}

// @param what  "site" or "reaction"
std::string trouble_of_places(const std::vector<Site>& sites, int V, std::string_view what) {
  for (const Site& site : sites) {
    const bool finite = site.direction.allFinite() && std::isfinite(site.full_load) &&
                        std::all_of(site.weights.begin(), site.weights.end(),
                                    [](float w) { return std::isfinite(w); });
    if (!finite) return fmt::format("a number of the {}s is not finite", what);
  }
  for (std::size_t s = 0; s < sites.size(); ++s) {
    std::string trouble = trouble_of_place(sites[s], V, fmt::format("{} {}", what, s));
    if (!trouble.empty()) return trouble;
  }
  return {};
}

std::string trouble_of_sites(const ReducedBody& body) {
  if (body.sites.empty()) return "the body has no site";
  std::string trouble = trouble_of_places(body.sites, body.surface.vertex_count(), "site");
  if (!trouble.empty()) return trouble;
  if (body.press_depth.cols() != std::ssize(body.sites)) {
    return "press_depth does not have one row per site";
  }
  if (!body.press_depth.allFinite()) return "a press depth is not finite";
  for (Eigen::Index s = 0; s < body.press_depth.cols(); ++s) {
    const auto column = body.press_depth.col(s);
    if (column.size() < 2 || column[0] != 0.0 || !is_rising(column)) {
      return fmt::format("the press depth of site {} does not grow with the load", s);
    }
  }
  for (const auto& [name, slopes] :
       {std::pair{"depth_slope", &body.depth_slope}, std::pair{"level_slope", &body.level_slope}}) {
    if (slopes->rows() != body.press_depth.rows() || slopes->cols() != body.press_depth.cols()) {
      return fmt::format("'{}' is not of the same size as the press depths", name);
    }
    if (!slopes->allFinite()) return fmt::format("'{}' is not a number somewhere", name);
  }
  return {};
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

std::string trouble_of_axes(const ReducedBody& body) {
  const auto S = std::ssize(body.sites);
  const int V = body.surface.vertex_count();
  if (body.displacement.value_count() != 3 * V || body.stress.value_count() != 6 * V) {
    return fmt::format("displacement and stress are not of the surface's {} vertices", V);
  }
  for (const SeparatedField* field : {&body.displacement, &body.stress}) {
    const Eigen::VectorXd& site = field->axes()[0].samples;
    const Eigen::VectorXd& level = field->axes()[1].samples;
    if (site.size() != S ||
        site != Eigen::VectorXd::LinSpaced(S, 0.0, static_cast<double>(S - 1))) {
      return "the site axis does not number the sites";
    }
    if (level.size() != body.press_depth.rows() || level.size() < 2 || level[0] != 0.0 ||
        level[level.size() - 1] != 1.0) {
      return "the level axis does not run from 0 to 1 in the steps of press_depth";
    }
  }
  return same_axes(body.displacement, body.stress)
             ? std::string()
             : "displacement and stress depend on different parameters";
}

// A cubic between two increasing samples increases if its slopes there are at least 0 and at most
// three times that of the secant.
std::string trouble_of_press(const ReducedBody& body) {
  const Eigen::VectorXd& levels = body.levels();
  constexpr double kRounding = 1 + 1e-9;
  for (Eigen::Index s = 0; s < body.press_depth.cols(); ++s) {
    for (Eigen::Index k = 0; k + 1 < levels.size(); ++k) {
      const double rise = body.press_depth(k + 1, s) - body.press_depth(k, s);
      const double run = levels[k + 1] - levels[k];
      for (const Eigen::Index end : {k, k + 1}) {
        const double depth = body.depth_slope(end, s), level = body.level_slope(end, s);
        const bool grows = depth >= 0 && depth * run <= 3 * rise * kRounding && level >= 0 &&
                           level * rise <= 3 * run * kRounding;
        if (!grows) return fmt::format("between samples the press of site {} does not grow", s);
      }
    }
  }
  return {};
}

std::string trouble_of_further(const ReducedBody& body) {
  if (body.is_settled()) return {};  // `further` may still name what it was settled on
  const std::vector<ParameterAxis>& axes = body.displacement.axes();
  if (body.further.size() + 2 != axes.size()) return "the parameters are not those of the fields";
  Eigen::Index K = 1;
  for (std::size_t j = 0; j < body.further.size(); ++j) {
    const FurtherParameter& p = body.further[j];
    const Eigen::VectorXd& samples = axes[j + 2].samples;
    if (p.name != axes[j + 2].name || p.samples.size() != samples.size() || p.samples != samples ||
        !(p.value >= samples[0] && p.value <= samples[samples.size() - 1])) {
      return fmt::format("the parameter '{}' is not that of the fields", p.name);
    }
    K *= samples.size();
  }
  const Eigen::MatrixXd &depth = body.further_press_depth, &load = body.further_full_load;
  const auto S = std::ssize(body.sites);
  if (depth.rows() != body.press_depth.rows() || load.rows() != S || load.cols() != K ||
      depth.cols() != S * K) {
    return "press depth and load are not known at all values of the further parameters";
  }
  if (!depth.allFinite() || !load.allFinite()) return "a depth or load is not a number";
  if (!(load.minCoeff() > 0)) return "a site has no load";
  for (const auto column : depth.colwise()) {
    if (column[0] != 0.0 || !is_rising(column)) return "a press depth does not grow";
  }
  return {};
}

std::string trouble_of_volume(const ReducedBody& body) {
  if (!body.volume) return {};
  const BodyVolume& volume = *body.volume;
  if (!volume.nodes.allFinite()) return "a node of the volume is not a point";
  if (volume.tets.rows() != 4 && volume.tets.rows() != 10) {
    return "the volume's elements are no tetrahedra";
  }
  for (const int node : volume.tets.reshaped()) {
    if (node < 0 || node >= volume.nodes.cols()) return "an element has no such node";
  }
  const Eigen::Index n = volume.nodes.cols();
  if (volume.displacement.value_count() != 3 * n ||
      (volume.stress && volume.stress->value_count() != 6 * n)) {
    return "the volume's fields are not of its nodes";
  }
  const bool same = same_axes(volume.displacement, body.displacement) &&
                    (!volume.stress || same_axes(*volume.stress, body.displacement));
  return same ? std::string() : "the volume depends on other parameters than the surface";
}

bool is_positive_definite(const QuarticEnergy& energy) {
  const Eigen::Index n = energy.modes();
  Eigen::MatrixXd K(n, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::Index i = 0; i < n; ++i) K(i, j) = energy.K[pair_row(i, j)];
  }
  return K.llt().info() == Eigen::Success;
}

std::string trouble_of_several(const ReducedBody& body) {
  if (!body.several) return {};
  const SeveralLoads& several = *body.several;
  const QuarticEnergy& energy = several.energy;
  const Eigen::Index n = several.mode_count(), P = distinct_count(n, 2);
  if (n < 1 || n > kMostSeveralModes || several.modes.cols() != n ||
      several.modes.rows() != 3 * Eigen::Index{body.surface.vertex_count()}) {
    return "the modes of several loads are not those of this surface";
  }
  if (energy.K.size() != P || energy.C.rows() != P || energy.D.rows() != P ||
      energy.D.cols() != P) {
    return "the modes of several loads are not those of their energy";
  }
  if (!energy.K.allFinite()) return "'quadratic' is not a number somewhere";
  if (!energy.C.allFinite()) return "'cubic' is not a number somewhere";
  if (!energy.D.allFinite()) return "'quartic' is not a number somewhere";
  if (!several.modes.allFinite()) return "a mode of several loads is not a number somewhere";
  if (!is_positive_definite(energy)) {
    return "the stiffness of several loads is not positive definite";
  }
  std::string trouble =
      trouble_of_places(several.reactions, body.surface.vertex_count(), "reaction");
  if (!trouble.empty()) return trouble;
  if (several.checked < 0 || !std::isfinite(several.error_worst) ||
      !(0 <= several.error_median && several.error_median <= several.error_worst)) {
    return "the error of several loads is not valid";
  }
  return body.is_settled() ? std::string() : "several loads do not go with further parameters";
}

bool are_errors(const auto& values) {  // finite, and none negative
  return values.allFinite() && (values.array() >= 0).all();
}

std::string trouble_of_course(const std::optional<ErrorCourse>& course, std::string_view name,
                              const ReducedBody& body) {
  if (!course) return {};
  const Eigen::Index one_point = (body.levels().size() - 1) * std::ssize(body.sites);
  const Eigen::Index q = course->modes.size(), K = course->snapshots.rows();
  if (q < 1 || course->pooled.size() != q || course->snapshots.cols() != q || K < one_point ||
      K % one_point != 0) {
    return fmt::format("'{}' is not of this body's snapshots", name);
  }
  if (!are_errors(course->pooled) || !are_errors(course->snapshots)) {
    return fmt::format("an error of '{}' is not valid", name);
  }
  if (course->modes[0] < 1 || !is_rising(course->modes)) {
    return fmt::format("the numbers of modes of '{}' do not increase", name);
  }
  return {};
}

std::string trouble_of_record(const HeldOutRecord& record, Eigen::Index S) {
  const Eigen::Index H = record.levels.size();
  if (H < 1 || !record.levels.allFinite()) return "the held-out levels are not valid";
  for (const Eigen::MatrixXf* errors : {&record.displacement, &record.von_mises}) {
    if (errors->rows() != H || errors->cols() != S) {
      return "'held_out' does not have one error for each level and site";
    }
  }
  if (!is_rising(record.levels)) return "the held-out levels do not increase";
  if (!are_errors(record.displacement) || !are_errors(record.von_mises) ||
      !(record.displacement_pooled >= 0) || !std::isfinite(record.displacement_pooled)) {
    return "an error of 'held_out' is not valid";
  }
  return {};
}

std::string trouble_of_errors(const ReducedBody& body) {
  const ReductionError& error = body.error;
  for (const double rounding : {error.displacement_rounding, error.stress_rounding}) {
    if (!(rounding >= 0) || !std::isfinite(rounding)) return "the error of rounding is not valid";
  }
  for (const auto& [name, course] : {std::pair{"displacement_course", &error.displacement_course},
                                     std::pair{"stress_course", &error.stress_course},
                                     std::pair{"von_mises_course", &error.von_mises_course}}) {
    std::string trouble = trouble_of_course(*course, name, body);
    if (!trouble.empty()) return trouble;
  }
  return error.held_out ? trouble_of_record(*error.held_out, std::ssize(body.sites))
                        : std::string();
}

}  // namespace

std::string trouble_of_field(const Eigen::MatrixXf& modes, const std::vector<ParameterAxis>& axes,
                             Eigen::Index values, std::string_view name) {
  if (modes.cols() < 1) return fmt::format("'{}' has no modes", name);
  if (modes.rows() != values) {
    return fmt::format("the modes of '{}' have {} values where {} are needed", name, modes.rows(),
                       values);
  }
  if (!modes.allFinite()) return fmt::format("a mode of '{}' is not a number somewhere", name);
  if (axes.size() < 2 || axes.size() > static_cast<std::size_t>(SeparatedField::kMostAxes)) {
    return fmt::format("'{}' does not depend on site and level", name);
  }
  for (std::size_t j = 0; j < axes.size(); ++j) {
    std::string trouble = trouble_of_axis(axes[j], static_cast<Eigen::Index>(j), modes.cols());
    if (!trouble.empty()) return trouble;
  }
  return {};
}

std::string trouble_of(const ReducedBody& body) {
  if (!std::isfinite(body.largest_von_mises) || body.largest_von_mises < 0.0) {
    return "largest_von_mises is not a stress";
  }
  // In this order: a later check uses what an earlier one has found to be right.
  for (const auto check :
       {trouble_of_surface, trouble_of_sites, trouble_of_axes, trouble_of_press, trouble_of_further,
        trouble_of_volume, trouble_of_several, trouble_of_errors}) {
    std::string trouble = check(body);
    if (!trouble.empty()) return trouble;
  }
  return {};
}

}  // namespace palpable

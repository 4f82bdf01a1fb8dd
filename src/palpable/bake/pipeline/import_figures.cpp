#include "palpable/bake/pipeline/import_figures.h"

#include "palpable/bake/describe/body_description.h"
#include "palpable/bake/describe/body_size.h"
#include "palpable/common/geometry/size_text.h"
#include "palpable/common/geometry/surface_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>

namespace palpable {
namespace {

// Bounds of the largest von Mises stress over the pressure below the patch. Presses on solid bodies
// have ratios around 1. A slender body that bends has up to a few thousand (two times the square of
// its length over its thickness), one pressed like a fluid a hundredth. A unit of stress that is
// off by a million (MPa and Pa) leaves the bounds in all but extreme bodies; one that is off by a
// thousand may stay inside.
constexpr double kLeastStress = 1e-3, kMostStress = 1e4;

double patch_area(const Site& site, const Eigen::VectorXd& areas) {
  double area = 0.0;
  for (const int v : site.patch) area += areas[v];
  return area;
}

std::vector<double> full_load_at(const ReducedBody& body, std::size_t site) {
  std::vector<double> mu{static_cast<double>(site), 1.0};
  for (const FurtherParameter& parameter : body.further) mu.push_back(parameter.value);
  return mu;
}

}  // namespace

ImportedFigures figures_of(const ReducedBody& body, bool has_loads) {
  ImportedFigures figures{.size = extent_of(body.surface.vertices), .load = {}};
  figures.stress = body.largest_von_mises;
  const Eigen::VectorXd areas = vertex_areas(body.surface);
  Eigen::Matrix3Xf u(3, body.surface.vertex_count());
  for (std::size_t s = 0; s < body.sites.size(); ++s) {
    body.displacement.evaluate(full_load_at(body, s),
                               std::span<float>(u.data(), static_cast<std::size_t>(u.size())));
    figures.displacement =
        std::max(figures.displacement, static_cast<double>(u.colwise().norm().maxCoeff()));
    if (!has_loads) continue;
    const double load = body.sites[s].full_load;
    figures.load = std::max(figures.load.value_or(0.0), load);
    figures.patch_pressure =
        std::max(figures.patch_pressure, load / patch_area(body.sites[s], areas));
  }
  return figures;
}

std::string figures_text(const ImportedFigures& figures) {
  return fmt::format(
      "{}; at full load: displacement up to {:.4g} mm, von Mises stress {}, load {}",
      size_text(figures.size), 1e3 * figures.displacement,
      figures.stress > 0.0 ? fmt::format("up to {:.4g} kPa", 1e-3 * figures.stress) : "not given",
      figures.load ? fmt::format("up to {:.4g} N", *figures.load) : "not given");
}

std::vector<std::string> import_warnings(const ImportedFigures& figures) {
  std::vector<std::string> warnings;
  constexpr const char* kRemedy = "the vertices in metres, not in {}";
  if (auto warning = size_warning(figures.size, 1.0, kRemedy)) warnings.push_back(*warning);
  const double range = BodyDescription::Press::kUsualRange * figures.size.maxCoeff();
  if (figures.displacement > range) {
    warnings.push_back(fmt::format(
        "a vertex moves by {:.4g} mm, more than {:.4g} mm, a third of the body's largest extent: "
        "displacement and vertices are metres; is one of them in mm, or in another order?",
        1e3 * figures.displacement, 1e3 * range));
  }
  if (figures.stress > 0.0 && figures.patch_pressure > 0.0) {
    const double ratio = figures.stress / figures.patch_pressure;
    if (ratio < kLeastStress || ratio > kMostStress) {
      warnings.push_back(
          fmt::format("von Mises stress is {:.3g} Pa where the load is {:.3g} Pa on its patch, "
                      "{:.1g} times that: stress is Pa and loads are N; is one of them in MPa, or "
                      "in kN?",
                      figures.stress, figures.patch_pressure, ratio));
    }
  }
  return warnings;
}

}  // namespace palpable

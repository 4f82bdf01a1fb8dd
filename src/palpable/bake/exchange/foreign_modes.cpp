#include "palpable/bake/exchange/foreign_modes.h"

#include "palpable/common/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace palpable {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

std::string names_of(const SeparatedField& field) {
  std::string names;
  for (const ParameterAxis& axis : field.axes()) names += fmt::format(" '{}'", axis.name);
  return names;
}

// Removes the axis of that name from the list and returns it; nothing if there is none.
std::optional<ParameterAxis> extract(std::vector<ParameterAxis>& axes, const std::string& name) {
  const auto found = std::find_if(axes.begin(), axes.end(),
                                  [&](const ParameterAxis& axis) { return axis.name == name; });
  if (found == axes.end()) return std::nullopt;
  ParameterAxis axis = std::move(*found);
  axes.erase(found);
  return axis;
}

// The field with its axes in the body's order: site, level from 0 (rest) to 1, then the others.
SeparatedField in_our_order(const SeparatedField& field, const ImportSettings& settings) {
  std::vector<ParameterAxis> others = field.axes(), axes;
  const Index m = field.mode_count();
  std::optional<ParameterAxis> site = extract(others, settings.site);
  if (!site) site = ParameterAxis{"", VectorXd::Zero(1), MatrixXd::Ones(1, m), Between::kNothing};
  std::optional<ParameterAxis> level = extract(others, settings.level);
  if (!level) {
    throw Error(fmt::format("there is no parameter '{}' that could be the load; there are{}",
                            settings.level, names_of(field)));
  }
  const Index S = site->samples.size(), L = level->samples.size();
  site->name = "site";
  site->between = Between::kNothing;
  site->samples = VectorXd::LinSpaced(S, 0.0, static_cast<double>(S - 1));
  level->name = "level";
  level->between = Between::kSmooth;
  if (!(level->samples[0] >= 0 && level->samples[L - 1] > 0)) {
    throw Error(
        fmt::format("the samples of '{}' do not run from 0 or more upwards", settings.level));
  }
  if (level->samples[0] > 0) {
    VectorXd samples(L + 1);
    samples << 0, level->samples;
    MatrixXd functions = MatrixXd::Zero(L + 1, m);
    functions.bottomRows(L) = level->functions;
    level->samples = samples;
    level->functions = functions;
  }
  level->samples /= level->samples[level->samples.size() - 1];
  axes = {std::move(*site), std::move(*level)};
  for (ParameterAxis& axis : others) {
    axis.between = Between::kSmooth;
    axes.push_back(std::move(axis));
  }
  return {field.modes(), std::move(axes)};
}

SeparatedField zero_stress(const SeparatedField& displacement) {
  std::vector<ParameterAxis> axes = displacement.axes();
  for (ParameterAxis& axis : axes) axis.functions = MatrixXd::Zero(axis.samples.size(), 1);
  return {Eigen::MatrixXf::Zero(2 * displacement.value_count(), 1), std::move(axes)};
}

Eigen::Vector3d at_vertex(const SeparatedField& u, const std::vector<double>& mu, int vertex) {
  Eigen::Vector3f value;
  u.evaluate_part(mu, 3 * vertex, std::span<float>(value.data(), 3));
  return value.cast<double>();
}

// Parameter values of a field: a site, a level, and one of the K combinations of samples of the
// further parameters.
class Points {
 public:
  explicit Points(const SeparatedField& u) : u_(u) {
    for (std::size_t j = 2; j < u.axes().size(); ++j) K_ *= u.axes()[j].samples.size();
  }

  [[nodiscard]] Index combinations() const { return K_; }

  /// @param k  combination; the last parameter's samples run fastest
  [[nodiscard]] std::vector<double> at(Index site, double level, Index k) const {
    std::vector<double> mu(u_.axes().size());
    mu[0] = static_cast<double>(site);
    mu[1] = level;
    for (std::size_t j = mu.size(); j-- > 2;) {
      const VectorXd& samples = u_.axes()[j].samples;
      mu[j] = samples[k % samples.size()];
      k /= samples.size();
    }
    return mu;
  }

 private:
  const SeparatedField& u_;
  Index K_ = 1;
};

// Vertex and load of site s: from the file, else where and along which the surface moves most.
// @param middle  parameters of the site at the last level
Site loaded_vertex(const ForeignModes& modes, const SeparatedField& u, Index s,
                   const std::vector<double>& middle) {
  const Index S = u.axes()[0].samples.size();
  const int V = modes.surface.vertex_count();
  Site site;
  if (!modes.site_vertices.empty()) {
    if (std::ssize(modes.site_vertices) != S || modes.site_loads.cols() != S) {
      throw Error(fmt::format("has {} vertices and {} loads of sites, where '{}' has {} samples",
                              modes.site_vertices.size(), modes.site_loads.cols(), u.axes()[0].name,
                              S));
    }
    site.vertex = modes.site_vertices[s];
    if (site.vertex < 0 || site.vertex >= V) {
      throw Error(
          fmt::format("site {} is at vertex {}, which the surface does not have", s, site.vertex));
    }
    site.direction = modes.site_loads.col(s);
  } else {
    Eigen::Matrix3Xf moved(3, V);
    u.evaluate(middle, std::span<float>(moved.data(), static_cast<std::size_t>(moved.size())));
    moved.colwise().squaredNorm().maxCoeff(&site.vertex);
    site.direction = moved.col(site.vertex).cast<double>().normalized();
  }
  site.full_load = site.direction.norm();
  if (!(site.full_load > 0 && std::isfinite(site.full_load)))
    throw Error(fmt::format("at site {} nothing moves", s));
  site.direction /= site.full_load;
  return site;
}

// How far the patch of site s moves along its load at each level, in combination k.
VectorXd press_depths(const SeparatedField& u, const Points& points, const Site& site, Index s,
                      Index k) {
  const VectorXd& levels = u.axes()[1].samples;
  VectorXd depth = VectorXd::Zero(levels.size());
  for (Index l = 1; l < levels.size(); ++l) {
    const std::vector<double> mu = points.at(s, levels[l], k);
    for (std::size_t i = 0; i < site.patch.size(); ++i) {
      depth[l] += static_cast<double>(site.weights[i]) *
                  site.direction.dot(at_vertex(u, mu, site.patch[i]));
    }
    if (!(depth[l] > depth[l - 1])) {
      throw Error(
          fmt::format("site {} does not give way farther from level {:.3g} to {:.3g}: {:.4g} m, "
                      "then {:.4g} m along its load",
                      s, levels[l - 1], levels[l], depth[l - 1], depth[l]));
    }
  }
  return depth;
}

// Name, surface, fields and parameters; no sites yet.
ReducedBody body_without_sites(const ForeignModes& modes, const ImportSettings& settings) {
  ReducedBody body{.name = settings.name,
                   .surface = modes.surface,
                   .fixed = {},
                   .sites = {},
                   .displacement = in_our_order(modes.displacement, settings),
                   .stress = modes.displacement,  // replaced below
                   .press_depth = {},
                   .error = {},
                   .material = "not known: modes of another program",
                   .provenance = settings.provenance};
  body.stress =
      modes.stress ? in_our_order(*modes.stress, settings) : zero_stress(body.displacement);
  const SeparatedField& u = body.displacement;
  for (int v = 0; v < modes.surface.vertex_count(); ++v) {
    body.fixed.push_back(u.modes().middleRows(3 * v, 3).isZero(0) ? 1 : 0);
  }
  for (std::size_t j = 2; j < u.axes().size(); ++j) {
    const VectorXd& samples = u.axes()[j].samples;
    body.further.push_back({u.axes()[j].name, samples, samples[samples.size() / 2]});
  }
  return body;
}

ReducedBody made_of_modes(const ForeignModes& modes, const ImportSettings& settings) {
  const WatertightReport report = check_watertight(modes.surface);
  if (!report.watertight()) throw Error("the surface is " + report.describe());
  const int V = modes.surface.vertex_count();
  if (modes.displacement.value_count() != 3 * V ||
      (modes.stress && modes.stress->value_count() != 6 * V)) {
    throw Error(fmt::format("the modes do not have 3 or 6 values for each of the {} vertices", V));
  }
  ReducedBody body = body_without_sites(modes, settings);
  const SeparatedField& u = body.displacement;
  const Points points(u);
  const Index L = u.axes()[1].samples.size(), S = u.axes()[0].samples.size();
  const Index K = points.combinations();
  const auto neighbours = vertex_neighbours(body.surface);
  const VectorXd areas = vertex_areas(body.surface);
  MatrixXd depth(L, S * K);
  MatrixXd load(S, K);
  std::vector<float> stress(6 * static_cast<std::size_t>(V)), mises(static_cast<std::size_t>(V));
  for (Index s = 0; s < S; ++s) {
    std::vector<double> middle = points.at(s, 1.0, 0);
    for (std::size_t j = 0; j < body.further.size(); ++j) middle[j + 2] = body.further[j].value;
    Site site = loaded_vertex(modes, u, s, middle);
    site.patch = graph_patch(neighbours, site.vertex, 2);
    double sum = 0;
    for (const int v : site.patch) sum += areas[v];
    for (const int v : site.patch) site.weights.push_back(static_cast<float>(areas[v] / sum));
    for (Index k = 0; k < K; ++k) {
      load(s, k) = site.full_load;
      depth.col(s + S * k) = press_depths(u, points, site, s, k);
    }
    body.stress.evaluate(middle, stress);
    von_mises(stress, mises);
    body.largest_von_mises = std::max(
        body.largest_von_mises, static_cast<double>(*std::max_element(mises.begin(), mises.end())));
    body.sites.push_back(std::move(site));
  }
  body.press_depth = depth.leftCols(S);
  if (!body.further.empty()) {
    body.further_press_depth = depth;
    body.further_full_load = load;
  }
  tabulate_press(body);
  return body;
}

}  // namespace

bool is_single_precision(const Eigen::MatrixXd& modes) {
  return modes.size() == 0 || modes.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= 1e30;
}

std::vector<int> vertex_numbers(const std::vector<double>& values, const std::string& name) {
  std::vector<int> numbers;
  for (const double v : values) {
    if (!(v >= 0 && v <= std::numeric_limits<int>::max()) || v != std::floor(v)) {
      throw Error(fmt::format("{}: {} is no number of a vertex", name, v));
    }
    numbers.push_back(static_cast<int>(v));
  }
  return numbers;
}

ReducedBody body_of_modes(const ForeignModes& modes, const ImportSettings& settings) {
  try {
    return made_of_modes(modes, settings);
  } catch (const Error& error) {
    if (settings.source.empty()) throw;
    throw Error(fmt::format("{}: {}", settings.source, error.what()));
  }
}

ForeignModes modes_of_body(const ReducedBody& body) {
  ForeignModes modes{body.surface, body.displacement, body.stress};
  modes.site_loads.resize(3, static_cast<Index>(body.sites.size()));
  for (std::size_t s = 0; s < body.sites.size(); ++s) {
    modes.site_vertices.push_back(body.sites[s].vertex);
    modes.site_loads.col(static_cast<Index>(s)) = body.sites[s].full_load * body.sites[s].direction;
  }
  return modes;
}

}  // namespace palpable

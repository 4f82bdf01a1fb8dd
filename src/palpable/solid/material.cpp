#include "palpable/solid/material.h"

#include "palpable/base/error.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace palpable {
namespace {

// A new law is one file and one row here (and its alternative of Material).
struct Law {
  std::string_view name;
  Material (*from_lame)(double lambda, double mu);
};
constexpr std::array kLaws = {
    Law{"neo-hookean",
        [](double lambda, double mu) -> Material {
          return NeoHookean{.C1 = 0.5 * mu, .D1 = 0.5 * lambda};
        }},
    Law{"saint-venant-kirchhoff",
        [](double lambda, double mu) -> Material {
          return SaintVenantKirchhoff{.lambda = lambda, .mu = mu};
        }},
    Law{"neo-hooke-abaqus",
        [](double lambda, double mu) -> Material {
          return NeoHookeanAbaqus{.C10 = 0.5 * mu, .D1 = 2.0 / (lambda + 2.0 / 3.0 * mu)};
        }},
    Law{"mooney-rivlin",
        [](double lambda, double mu) -> Material {
          const double C2 = std::min(0.1 * mu, 0.25 * lambda);
          return MooneyRivlin{.C1 = 0.5 * mu - C2, .C2 = C2, .D1 = 0.5 * lambda - 2.0 * C2};
        }},
};
static_assert(kLaws.size() == std::variant_size_v<Material>);

}  // namespace

const std::vector<std::string>& law_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const Law& law : kLaws) list.emplace_back(law.name);
    return list;
  }();
  return names;
}

std::string law_name(const Material& material) { return law_names()[material.index()]; }

Material material_from_young(std::string_view law, double E, double nu) {
  if (!(E > 0.0) || !std::isfinite(E)) {
    throw Error(fmt::format("Young's modulus is {} Pa; it must be above 0 (soft rubber: 60e3)", E));
  }
  if (!(nu >= 0.0 && nu < 0.5)) {
    throw Error(fmt::format(
        "Poisson's ratio is {}; it must be at least 0 and below 0.5, where the body would be "
        "incompressible (try 0.4)",
        nu));
  }
  const double mu = E / (2.0 * (1.0 + nu));
  const double lambda = E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
  for (const Law& known : kLaws) {
    if (known.name == law) return known.from_lame(lambda, mu);
  }
  std::string names;
  for (const Law& known : kLaws)
    names += fmt::format("{}\"{}\"", names.empty() ? "" : ", ", known.name);
  throw Error(fmt::format("unknown material law \"{}\"; known are {}", law, names));
}

LameConstants lame_constants(const Material& material) {
  if (const auto* m = std::get_if<NeoHookean>(&material)) return {2.0 * m->D1, 2.0 * m->C1};
  if (const auto* m = std::get_if<NeoHookeanAbaqus>(&material)) {
    return {2.0 / m->D1 - 4.0 / 3.0 * m->C10, 2.0 * m->C10};
  }
  if (const auto* m = std::get_if<MooneyRivlin>(&material)) {
    return {2.0 * m->D1 + 4.0 * m->C2, 2.0 * (m->C1 + m->C2)};
  }
  const auto& m = std::get<SaintVenantKirchhoff>(material);
  return {m.lambda, m.mu};
}

void check_material(const Material& material) {
  const auto [lambda, mu] = lame_constants(material);
  // Where lambda is a difference (2/D1 - 4/3 C10), nu = 0 may leave a rounding below zero.
  const double rounding = 1e-12 * mu;
  if (!(mu > 0.0) || !std::isfinite(mu) || !(lambda >= -rounding) || !std::isfinite(lambda)) {
    throw Error(fmt::format(
        "material {} has mu = {} Pa and lambda = {} Pa; mu must be above 0 and lambda at least 0",
        law_name(material), mu, lambda));
  }
  if (const auto* m = std::get_if<MooneyRivlin>(&material)) {
    if (m->C1 >= 0.0 && m->C2 >= 0.0 && m->D1 >= 0.0) return;
    throw Error(fmt::format(
        "material mooney-rivlin has C1 = {} Pa, C2 = {} Pa and D1 = {} Pa; none may be negative",
        m->C1, m->C2, m->D1));
  }
}

double energy_density(const Material& material, const Eigen::Matrix3d& F) {
  return std::visit([&](const auto& law) { return energy_density(law, F); }, material);
}

Eigen::Matrix3d first_piola(const Material& material, const Eigen::Matrix3d& F) {
  return std::visit([&](const auto& law) { return first_piola(law, F); }, material);
}

Tangent tangent(const Material& material, const Eigen::Matrix3d& F) {
  return std::visit([&](const auto& law) { return tangent(law, F); }, material);
}

}  // namespace palpable

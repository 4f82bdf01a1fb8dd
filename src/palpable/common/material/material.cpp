#include "palpable/common/material/material.h"

#include "palpable/common/base/bit_cast.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/text_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

namespace palpable {
namespace {

// Name, constants and conversions of one alternative of Material.
struct Law {
  std::string_view name;
  std::span<const LawConstant> constants;
  Material (*from_lame)(LameConstants);
  Material (*from_values)(std::span<const double>);  // one for each constant
};

template <class L>
constexpr Law row() {
  using Values = std::array<double, L::kConstants.size()>;
  static_assert(sizeof(L) == sizeof(Values), "a law is its constants, in the order of kConstants");
  return {L::kName, L::kConstants, [](LameConstants k) -> Material { return L::from_lame(k); },
          [](std::span<const double> given) -> Material {
            Values values;
            std::copy_n(given.begin(), values.size(), values.begin());
            return bit_cast<L>(values);
          }};
}
template <class... Laws>
constexpr std::array<Law, sizeof...(Laws)> table_of(std::type_identity<std::variant<Laws...>>) {
  return {row<Laws>()...};
}
constexpr auto kLaws = table_of(std::type_identity<Material>{});

const Law& law_of(std::string_view name) {
  for (const Law& law : kLaws) {
    if (law.name == name) return law;
  }
  throw Error(fmt::format("unknown material law \"{}\"; known are \"{}\"", name,
                          fmt::join(law_names(), "\", \"")));
}

// The values of a law's constants.
template <class L>
std::array<double, L::kConstants.size()> values_of(const L& law) {
  return bit_cast<std::array<double, L::kConstants.size()>>(law);
}

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
  return law_of(law).from_lame({.lambda = lambda, .mu = mu});
}

std::span<const LawConstant> law_constants(std::string_view law) { return law_of(law).constants; }

std::vector<double> constants_of(const Material& material) {
  return std::visit(
      [](const auto& law) {
        const auto values = values_of(law);
        return std::vector<double>(values.begin(), values.end());
      },
      material);
}

Material material_from_constants(std::string_view law, std::span<const double> values) {
  const Law& known = law_of(law);
  PALPABLE_EXPECT(values.size() == known.constants.size(), "one value for each constant");
  const Material material = known.from_values(values);
  check_material(material);
  return material;
}

LameConstants lame_constants(const Material& material) {
  return std::visit([](const auto& law) { return law.lame(); }, material);
}

YoungPoisson young_poisson(const Material& material) {
  const auto [lambda, mu] = lame_constants(material);
  return {mu * (3.0 * lambda + 2.0 * mu) / (lambda + mu), 0.5 * lambda / (lambda + mu)};
}

std::string poisson_text(double poisson) {
  const double from_half = std::abs(0.5 - poisson);
  const double relative =
      from_half > 0.0 ? std::min(1e-9, 1e-3 * from_half / std::abs(poisson)) : 1e-14;
  return number_text(poisson, relative);
}

std::string stiffness_text(double young) {
  struct Thing {
    double below;  // Pa
    const char* name;
  };
  // Orders of magnitude: for somebody who compares them with the body that was meant.
  constexpr std::array kThings{Thing{3e3, "softer than a jelly"},
                               Thing{3e4, "as of a jelly"},
                               Thing{3e5, "as of a very soft rubber"},
                               Thing{3e7, "as of rubber"},
                               Thing{3e8, "as of a soft plastic"},
                               Thing{8e9, "as of a hard plastic"},
                               Thing{4e10, "as of concrete"},
                               Thing{1e11, "as of glass or aluminium"},
                               Thing{3e11, "as of steel"},
                               Thing{kStiffest, "as of a ceramic"}};
  const auto thing =
      std::find_if(kThings.begin(), kThings.end(), [&](const Thing& t) { return young < t.below; });
  return fmt::format("{} Pa, {}", number_text(young),
                     thing == kThings.end() ? "stiffer than diamond" : thing->name);
}

void check_material(const Material& material) {
  std::visit(
      [](const auto& law) {
        const auto values = values_of(law);
        for (std::size_t k = 0; k < values.size(); ++k) {
          const LawConstant& constant = law.kConstants[k];
          const bool fits = constant.may_be_zero ? values[k] >= 0.0 : values[k] > 0.0;
          if (fits && std::isfinite(values[k])) continue;
          throw Error(fmt::format("material {} has {} = {} {}; it must be {} 0", law.kName,
                                  constant.name, values[k], constant.per_pressure ? "1/Pa" : "Pa",
                                  constant.may_be_zero ? "at least" : "above"));
        }
      },
      material);
  const auto [lambda, mu] = lame_constants(material);
  // In laws where lambda is a difference (2/D1 - 4/3 C10), nu = 0 may give a negative rounding
  // error.
  const double rounding = 1e-12 * mu;
  if (!(mu > 0.0) || !std::isfinite(mu) || !(lambda >= -rounding) || !std::isfinite(lambda)) {
    throw Error(fmt::format(
        "material {} has mu = {} Pa and lambda = {} Pa; mu must be above 0 and lambda at least 0",
        law_name(material), mu, lambda));
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

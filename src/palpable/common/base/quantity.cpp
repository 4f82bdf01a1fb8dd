#include "palpable/common/base/quantity.h"

#include "palpable/common/base/double_chars.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <system_error>
#include <utility>

namespace palpable {
namespace {

struct Unit {
  std::string_view name;  // as unit_word() makes it: "kg/m3"
  double size;            // of the unit, in SI
};
// The first ones of each kind are those that messages name.
constexpr std::array kLengths{Unit{"m", 1.0},        Unit{"cm", 1e-2}, Unit{"mm", 1e-3},
                              Unit{"in", 0.0254},    Unit{"um", 1e-6}, Unit{"ft", 0.3048},
                              Unit{"dm", 1e-1},      Unit{"km", 1e3},  Unit{"inch", 0.0254},
                              Unit{"inches", 0.0254}};
constexpr std::size_t kNamedLengths = 4;
constexpr double kPsi = 6894.757293168361;  // 1 lbf / in^2
constexpr std::array kPressures{Unit{"Pa", 1.0},    Unit{"kPa", 1e3},       Unit{"MPa", 1e6},
                                Unit{"GPa", 1e9},   Unit{"N/m2", 1.0},      Unit{"N/cm2", 1e4},
                                Unit{"N/mm2", 1e6}, Unit{"kN/m2", 1e3},     Unit{"kN/mm2", 1e9},
                                Unit{"hPa", 1e2},   Unit{"bar", 1e5},       Unit{"mbar", 1e2},
                                Unit{"psi", kPsi},  Unit{"ksi", 1e3 * kPsi}};
constexpr std::array kPerPressures{
    Unit{"1/Pa", 1.0},   Unit{"1/kPa", 1e-3},       Unit{"1/MPa", 1e-6},
    Unit{"1/GPa", 1e-9}, Unit{"m2/N", 1.0},         Unit{"mm2/N", 1e-6},
    Unit{"Pa-1", 1.0},   Unit{"kPa-1", 1e-3},       Unit{"MPa-1", 1e-6},
    Unit{"GPa-1", 1e-9}, Unit{"1/psi", 1.0 / kPsi}, Unit{"1/ksi", 1e-3 / kPsi}};
constexpr std::array kForces{Unit{"N", 1.0}, Unit{"mN", 1e-3}, Unit{"kN", 1e3}, Unit{"uN", 1e-6},
                             Unit{"lbf", 4.4482216152605}};
constexpr std::array kDensities{Unit{"kg/m3", 1.0},  Unit{"g/cm3", 1e3},     Unit{"t/m3", 1e3},
                                Unit{"t/mm3", 1e12}, Unit{"kg/mm3", 1e9},    Unit{"g/mm3", 1e6},
                                Unit{"kg/dm3", 1e3}, Unit{"kg/l", 1e3},      Unit{"kg/L", 1e3},
                                Unit{"g/ml", 1e3},   Unit{"g/mL", 1e3},      Unit{"g/l", 1.0},
                                Unit{"g/L", 1.0},    Unit{"tonne/mm3", 1e12}};
constexpr std::array kAccelerations{Unit{"m/s2", 1.0}, Unit{"cm/s2", 1e-2}, Unit{"mm/s2", 1e-3},
                                    Unit{"in/s2", 0.0254}};

struct Units {
  std::span<const Unit> units;
  const char* example;
};
Units units_of(Quantity kind) {
  switch (kind) {
    case Quantity::kLength:
      return {kLengths, "150 mm"};
    case Quantity::kPressure:
      return {kPressures, "60 kPa"};
    case Quantity::kPerPressure:
      return {kPerPressures, "0.05 1/kPa"};
    case Quantity::kForce:
      return {kForces, "2 N"};
    case Quantity::kDensity:
      return {kDensities, "1000 kg/m^3"};
    case Quantity::kAcceleration:
      break;
  }
  return {kAccelerations, "9.81 m/s^2"};
}

// A unit as the tables have it: "kg/m^3", "kg/m³" and "kg / m**3" are "kg/m3".
std::string unit_word(std::string_view text) {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 8> kWritings{
      {{" /", "/"},
       {"/ ", "/"},
       {"**", "^"},
       {"²", "^2"},
       {"³", "^3"},
       {"⁻¹", "^-1"},
       {"µ", "u"},
       {"μ", "u"}}};
  std::string word(text);
  for (const auto& [written, as] : kWritings) {
    for (std::size_t at = word.find(written); at != std::string::npos; at = word.find(written)) {
      word.replace(at, written.size(), as);
    }
  }
  // A power follows its unit: "^mm" is none.
  for (std::size_t at = word.find('^', 1); at != std::string::npos; at = word.find('^', at)) {
    word.erase(at, 1);
  }
  return word;
}

// The number that a text begins with, and what follows it.
struct Written {
  std::optional<double> number;
  std::string_view unit;
};
Written split_quantity(std::string_view text) {
  double number = 0;
  const char* end = text.data() + text.size();
  const auto [rest, code] = double_from_chars(text.data(), end, number);
  if (code != std::errc()) return {std::nullopt, text};
  std::string_view unit(rest, static_cast<std::size_t>(end - rest));
  unit.remove_prefix(std::min(unit.find_first_not_of(' '), unit.size()));
  return {number, unit};
}

const Unit* find_unit(std::string_view written, Quantity kind) {
  if (written.empty() || written.back() == ' ') return nullptr;
  const std::string word = unit_word(written);
  for (const Unit& known : units_of(kind).units) {
    if (known.name == word) return &known;
  }
  return nullptr;
}

}  // namespace

std::optional<double> to_quantity(std::string_view text, Quantity kind) {
  const auto [number, unit] = split_quantity(text);
  const Unit* known = number ? find_unit(unit, kind) : nullptr;
  if (known == nullptr) return std::nullopt;
  return *number * known->size;
}

std::string why_no_quantity(std::string_view text, Quantity kind) {
  const auto [number, unit] = split_quantity(text);
  const std::string example =
      fmt::format("must be a text with a unit, such as \"{}\"", example_of(kind));
  if (!number) return example;
  if (unit.size() > 1 && unit[0] == ',' && unit[1] >= '0' && unit[1] <= '9') {
    return "has a decimal comma; write 0.5, not 0,5";
  }
  std::vector<std::string_view> names;
  for (const Unit& known : units_of(kind).units) names.push_back(known.name);
  const std::string known = fmt::format("the units known here are {}", fmt::join(names, ", "));
  return fmt::format("{}; {}", example, known);
}

std::optional<double> length_unit(std::string_view name) {
  const Unit* known = find_unit(name, Quantity::kLength);
  return known != nullptr ? std::optional(known->size) : std::nullopt;
}

std::vector<std::string> length_unit_names() {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < kNamedLengths; ++k) names.emplace_back(kLengths[k].name);
  return names;
}

const char* example_of(Quantity kind) { return units_of(kind).example; }

}  // namespace palpable

#include "palpable/common/base/quantity.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <span>

namespace palpable {
namespace {

struct Unit {
  std::string_view name;
  double size;  // of the unit, in SI
};
constexpr std::array kLengths{Unit{"m", 1.0}, Unit{"cm", 1e-2}, Unit{"mm", 1e-3}};
constexpr std::array kPressures{Unit{"Pa", 1.0}, Unit{"kPa", 1e3}, Unit{"MPa", 1e6},
                                Unit{"GPa", 1e9}};
constexpr std::array kPerPressures{Unit{"1/Pa", 1.0}, Unit{"1/kPa", 1e-3}, Unit{"1/MPa", 1e-6},
                                   Unit{"1/GPa", 1e-9}};
constexpr std::array kForces{Unit{"N", 1.0}, Unit{"mN", 1e-3}, Unit{"kN", 1e3}};
constexpr std::array kDensities{Unit{"kg/m^3", 1.0}, Unit{"g/cm^3", 1e3}};
constexpr std::array kAccelerations{Unit{"m/s^2", 1.0}};

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

}  // namespace

std::optional<double> to_quantity(std::string_view text, Quantity kind) {
  double number = 0;
  const char* end = text.data() + text.size();
  const auto [rest, code] = std::from_chars(text.data(), end, number);
  if (code != std::errc()) return std::nullopt;
  std::string_view unit(rest, static_cast<std::size_t>(end - rest));
  unit.remove_prefix(std::min(unit.find_first_not_of(' '), unit.size()));
  for (const Unit& known : units_of(kind).units) {
    if (known.name == unit) return number * known.size;
  }
  return std::nullopt;
}

const char* example_of(Quantity kind) { return units_of(kind).example; }

}  // namespace palpable

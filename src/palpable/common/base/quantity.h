/// @file
/// Reads quantities with a unit, such as "150 mm", from files and from the command line.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpable {

/// The kind of quantity that a text with a unit gives.
enum class Quantity { kLength, kPressure, kPerPressure, kForce, kDensity, kAcceleration };

/// The number in SI units: "7mm" and "7 mm" are 0.007; "kg/m^3", "kg/m3" and "kg/m³" are one unit.
/// Nothing if the text is not a number followed by a unit of this kind. A number without unit is
/// refused, too; infinity is not. Case counts: mPa is not MPa.
[[nodiscard]] std::optional<double> to_quantity(std::string_view text, Quantity kind);

/// Why to_quantity() gives nothing, as the end of a sentence about the text: "must be a text with a
/// unit, such as "60 kPa"; the units known here are Pa, kPa, ...".
[[nodiscard]] std::string why_no_quantity(std::string_view text, Quantity kind);

/// The size, m, of the unit of length with this name, one that to_quantity() knows, else nothing.
[[nodiscard]] std::optional<double> length_unit(std::string_view name);

/// The names of the usual units of length: m, cm, mm, in (inches of 25.4 mm).
[[nodiscard]] std::vector<std::string> length_unit_names();

/// A text that to_quantity() accepts, for messages: "150 mm".
[[nodiscard]] const char* example_of(Quantity kind);

}  // namespace palpable

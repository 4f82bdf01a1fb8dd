/// @file
/// Reads quantities with a unit, such as "150 mm", from files and from the command line.
#pragma once

#include <optional>
#include <string_view>

namespace palpable {

/// The kind of quantity that a text with a unit gives.
enum class Quantity { kLength, kPressure, kPerPressure, kForce, kDensity, kAcceleration };

/// The number in SI units: "7mm" and "7 mm" are 0.007. Nothing if the text is not a number followed
/// by a unit of this kind. A number without unit is refused, too; infinity is not.
[[nodiscard]] std::optional<double> to_quantity(std::string_view text, Quantity kind);

/// A text that to_quantity() accepts, for messages: "150 mm".
[[nodiscard]] const char* example_of(Quantity kind);

}  // namespace palpable

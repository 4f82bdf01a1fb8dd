/// @file
/// Checks the size of a body before anything takes minutes: most wrong sizes come from a forgotten
/// unit.
#pragma once

#include "palpable/bake/describe/body_description.h"

#include <Eigen/Core>

#include <optional>
#include <string>

namespace palpable {

/// Bounds of the largest extent, m. Bodies outside of them are refused: the tolerances of the
/// mesher and the solver are made for things on a desk.
inline constexpr double kSmallestBody = 1e-4, kLargestBody = 100.0;
/// Bounds of the largest extent, m, outside of which a body gets a warning.
inline constexpr double kSmallBody = 3e-3, kLargeBody = 3.0;

/// A warning about a body outside of kSmallBody and kLargeBody, with the unit that the file's
/// lengths probably have and what to write; nothing for usual sizes.
/// @param size   m
/// @param unit   m, assumed unit of lengths in the file; none: the body was scaled to a height
/// @param write  how to give a unit, with {} for its name: "unit = \"{}\" in [shape]"
[[nodiscard]] std::optional<std::string> size_warning(const Eigen::Vector3d& size,
                                                      std::optional<double> unit,
                                                      const std::string& write);

/// size_warning() of a description's shape, beginning with file and line.
[[nodiscard]] std::optional<std::string> size_warning(const BodyDescription::Shape& shape,
                                                      const Eigen::Vector3d& size);

/// @param place  how the message begins
/// @throws Error as size_warning() has it, outside of kSmallestBody and kLargestBody
void require_possible_size(const Eigen::Vector3d& size, std::optional<double> unit,
                           const std::string& write, const std::string& place);
void require_possible_size(const BodyDescription::Shape& shape, const Eigen::Vector3d& size);

}  // namespace palpable

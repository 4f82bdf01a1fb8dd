/// @file
/// Checks the rules of reduced_body.h. Every reader of body files fills a ReducedBody from the file
/// and then calls these functions to learn whether it is a valid body.
///
/// All functions return the first broken rule in one line, without the file's name; empty if none
/// is broken. They read nothing outside the data, whatever the data holds.
#pragma once

#include "palpable/common/reduced/reduced_body.h"
#include "palpable/common/reduced/separated_field.h"

#include <Eigen/Core>

#include <string>
#include <string_view>
#include <vector>

namespace palpable {

/// Largest number of modes of SeveralLoads: with more, Newton's method would be too slow for the
/// frame loop. At 64 the quartic coefficients take 35 MB in memory.
inline constexpr int kMostSeveralModes = 64;

/// Whether modes and axes may become a field of a body: the site, the level, then further
/// parameters. To be called before the SeparatedField is made, whose constructor throws.
/// @param modes   (N x m)
/// @param values  the N that is needed
/// @param name    of the field, for the line: "displacement"
[[nodiscard]] std::string trouble_of_field(const Eigen::MatrixXf& modes,
                                           const std::vector<ParameterAxis>& axes,
                                           Eigen::Index values, std::string_view name);

/// All other rules. @pre the body's fields, those of its volume too, have passed trouble_of_field()
[[nodiscard]] std::string trouble_of(const ReducedBody& body);

}  // namespace palpable

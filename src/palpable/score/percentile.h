/// @file
/// One number for many.
#pragma once

#include <vector>

namespace palpable {

/// The value below which a share of the values lies: linear between the two nearest ranks, so that
/// share 0.5 of an even number of values is the mean of the middle two.
/// @param values  at least one, no NaN; any order
/// @param share   in [0, 1]
[[nodiscard]] double percentile(std::vector<double> values, double share);

}  // namespace palpable

/// @file
/// The unit of the times in a file whose format has seconds: some programs write the nanoseconds or
/// microseconds of their clock instead.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace palpable {

/// "nanoseconds", "microseconds" or "milliseconds" if the times cannot be seconds, else empty.
///
/// A time of day of these units is above 1e11, the year 5138 in seconds. Smaller times are judged
/// by their median step: from 1000 on it is one of microseconds (1 kHz to 1 Hz), from 1e6 on of
/// nanoseconds. Steps of milliseconds cannot be told from those of seconds.
/// @param times  in their order; the median step is that of their sorted differences
[[nodiscard]] std::string_view unit_of_times(const std::vector<double>& times);

/// One line, without a file's name, for times that are not seconds; empty if they can be.
[[nodiscard]] std::string what_is_wrong_with_times(const std::vector<double>& times);

}  // namespace palpable

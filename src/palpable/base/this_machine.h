/// @file
/// Facts that reports state beside their measurements: the machine, memory, processor time, the
/// day.
#pragma once

#include <string>

namespace palpable {

/// The most memory that this process ever held, bytes.
[[nodiscard]] double peak_memory();

/// The time that processors have spent on this process, all threads together and the system's share
/// too, s. Other processes that it started are not in it.
[[nodiscard]] double process_cpu();

/// The processor's name in /proc/cpuinfo with the number of cores: "..., 2 cores".
[[nodiscard]] std::string processor_name();

/// Today by UTC, as in "2026-11-21".
[[nodiscard]] std::string date_today();

}  // namespace palpable

/// @file
/// Where and when something was measured: what stands beside the figures of a report.
#pragma once

#include <string>

namespace palpable {

/// The most memory that this process ever held, bytes.
[[nodiscard]] double peak_memory();

/// As /proc/cpuinfo names it, with the number of cores: "..., 2 cores".
[[nodiscard]] std::string processor_name();

/// Today by UTC, "2026-11-21": beside what was measured today.
[[nodiscard]] std::string date_today();

}  // namespace palpable

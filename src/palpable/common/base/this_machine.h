/// @file
/// Facts of the process and where it runs: memory, processor time, the machine, the day; reports
/// state them beside their measurements.
#pragma once

#include <filesystem>
#include <string>

namespace palpable {

/// The most memory that this process ever held, bytes.
[[nodiscard]] double peak_memory();

/// The time that processors have spent on this process, all threads together and the system's share
/// too, s. Other processes that it started are not in it.
[[nodiscard]] double process_cpu();

/// The processor's name in /proc/cpuinfo with the number of cores: "..., 2 cores".
[[nodiscard]] std::string processor_name();

/// The folder of the running program's file, where its companions lie.
/// @throws Error where the system does not tell
[[nodiscard]] std::filesystem::path folder_of_program();

/// Today by UTC, as in "2026-11-21".
[[nodiscard]] std::string date_today();

}  // namespace palpable

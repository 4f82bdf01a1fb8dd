/// @file
/// Facts about the process and its machine (memory, processor, date), which reports
/// state beside their measurements.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace palpable {

/// The largest memory that this process has held so far, bytes.
[[nodiscard]] double peak_memory();

/// Memory that programs may still use without swapping, bytes (MemAvailable). Nothing if the system
/// does not say.
[[nodiscard]] std::optional<double> available_memory();

/// The user's folder of one kind by the XDG Base Directory Specification: that of an environment
/// variable, or one in the home directory. Nothing if both are unknown.
/// @param variable    "XDG_CACHE_HOME"
/// @param below_home  ".cache"
[[nodiscard]] std::optional<std::filesystem::path> user_folder(const char* variable,
                                                               const char* below_home);

/// The processor's name in /proc/cpuinfo with the number of cores: "..., 2 cores".
[[nodiscard]] std::string processor_name();

/// The folder of the running program's file, in which the files that belong to it lie.
/// @throws Error if the system does not provide it
[[nodiscard]] std::filesystem::path folder_of_program();

/// Today's date in UTC, such as "2026-11-21".
[[nodiscard]] std::string date_today();

}  // namespace palpable

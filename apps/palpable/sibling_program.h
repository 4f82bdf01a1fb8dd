/// @file
/// The project's other programs in the folder of this one: the solver and the benchmarks.
#pragma once

#include <filesystem>
#include <string_view>

namespace palpable::app {

inline constexpr const char* kBakeProgram = "palpable-bake";    ///< the offline half
inline constexpr const char* kBenchProgram = "palpable-bench";  ///< benchmarks of the live half
inline constexpr const char* kBakeBenchProgram =
    "palpable-bake-bench";  ///< benchmarks of the offline half

/// The path of a program. @throws Error when this program's own folder is unknown
[[nodiscard]] std::filesystem::path sibling_program(std::string_view name);

}  // namespace palpable::app

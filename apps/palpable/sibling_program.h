/// @file
/// The project's other programs, which lie in the folder of this one: the solver and the benches.
#pragma once

#include <filesystem>
#include <string_view>

namespace palpable::app {

inline constexpr const char* kBakeProgram = "palpable-bake";    ///< the offline half
inline constexpr const char* kBenchProgram = "palpable-bench";  ///< benches of the live half
inline constexpr const char* kBakeBenchProgram =
    "palpable-bake-bench";  ///< benches of the offline half

/// Where the program lies. @throws Error when this program's own folder is not known
[[nodiscard]] std::filesystem::path sibling_program(std::string_view name);

}  // namespace palpable::app

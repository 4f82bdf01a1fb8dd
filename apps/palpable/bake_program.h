/// @file
/// The other program, which has the solver.
#pragma once

#include <filesystem>

namespace palpable::app {

/// palpable-bake, in the folder of this program. @throws Error when that folder is not known
[[nodiscard]] std::filesystem::path bake_program();

}  // namespace palpable::app

/// @file
/// The body that is pressed where none is named.
#pragma once

#include <filesystem>

namespace palpable::app {

/// The body of sequences and benches unless told otherwise: the dense bunny if it was baked, else
/// the demo's. @throws Error when neither is there
[[nodiscard]] std::filesystem::path default_body();

}  // namespace palpable::app

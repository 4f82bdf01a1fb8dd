/// @file
/// The body that is pressed where none is named, and those that are installed with the program.
#pragma once

#include <filesystem>

namespace palpable::app {

/// Where an installed copy keeps its bodies: ../share/palpable/bodies beside the program's folder.
[[nodiscard]] std::filesystem::path shipped_bodies();

/// The body of sequences and benches unless told otherwise: the dense bunny if it was baked, else
/// the demo's, else the post that an installed copy brings.
/// @throws Error when none of them is there
[[nodiscard]] std::filesystem::path default_body();

/// What a user means by `name`: a bare word such as "post", which names no file here, is the
/// installed body of that name, if there is one. Everything else stays as it is, an empty name too.
[[nodiscard]] std::filesystem::path find_body(const std::filesystem::path& name,
                                              const std::filesystem::path& shipped);
[[nodiscard]] std::filesystem::path find_body(const std::filesystem::path& name);

}  // namespace palpable::app

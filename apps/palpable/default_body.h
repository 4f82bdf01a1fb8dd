/// @file
/// The default body, and the bodies that are installed with the program.
#pragma once

#include <filesystem>

namespace palpable::app {

/// The folder with the bodies of an installed copy: ../share/palpable/bodies relative to the
/// program's folder.
[[nodiscard]] std::filesystem::path shipped_bodies();

/// The default body of sequences and benchmarks: the dense bunny if it was baked, else the demo's
/// body, else the post of an installed copy.
/// @throws Error when none of them exists
[[nodiscard]] std::filesystem::path default_body();

/// The body file for a name that a user gave. A bare word such as "post" that is not a file here
/// is the installed body of that name, if there is one. Any other name is returned unchanged,
/// also an empty one.
[[nodiscard]] std::filesystem::path find_body(const std::filesystem::path& name,
                                              const std::filesystem::path& shipped);
[[nodiscard]] std::filesystem::path find_body(const std::filesystem::path& name);

}  // namespace palpable::app

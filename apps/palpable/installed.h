/// @file
/// What is installed with this program: bodies, among them the default one, and the project's other
/// programs.
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

/// The folder with the bodies of an installed copy: ../share/palpable/bodies relative to the
/// program's folder.
[[nodiscard]] std::filesystem::path shipped_bodies();

/// The folder with the bundle of pages: ../share/palpable/web of an installed copy, else where
/// web/page/build.mjs makes it, in the source folder.
[[nodiscard]] std::filesystem::path shipped_page();

/// The default body of sequences and benchmarks: the dense bunny if it was baked, else the demo's
/// body, else the post of an installed copy.
/// @throws Error when none of them exists
[[nodiscard]] std::filesystem::path default_body();

/// The body of `live` without arguments: the post of an installed copy, else default_body().
/// @throws Error when there is none
[[nodiscard]] std::filesystem::path shipped_body();

/// The body file for a name that a user gave. A bare word such as "post" that is not a file here
/// is the installed body of that name. Any other name is returned unchanged, also an empty one.
/// @throws Error when the word is neither
[[nodiscard]] std::filesystem::path find_body(const std::filesystem::path& name,
                                              const std::filesystem::path& shipped);
[[nodiscard]] std::filesystem::path find_body(const std::filesystem::path& name);

}  // namespace palpable::app

/// @file
/// Functions that sanitizers look up by name in a test program.
#pragma once

namespace palpable::test {

/// Returns true. main() calls it, because the linker takes an object out of a library only if
/// something in it is used; then the sanitizers find the other names, too.
[[nodiscard]] bool sanitizer_names_are_here();

}  // namespace palpable::test

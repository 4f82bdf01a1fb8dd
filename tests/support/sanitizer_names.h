/// @file
/// The names by which sanitizers ask a test program for its settings.
#pragma once

namespace palpable::test {

/// True. main() asks, because the linker takes an object out of a library only if somebody does,
/// and then the sanitizers find their names, too.
[[nodiscard]] bool sanitizer_names_are_here();

}  // namespace palpable::test

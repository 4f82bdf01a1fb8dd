/// @file
/// The list of sequences, and the plan of each; docs/benchmark.md says what each promises.
///
/// A plan is a pure function of name, body, length and seed.
#pragma once

#include "palpable/desk/script/desk_body.h"
#include "palpable/desk/script/sequence.h"

#include <cstdint>
#include <span>
#include <string_view>

namespace palpable {

/// A sequence that can be planned.
struct SequenceKind {
  std::string_view name;
  int frames;  ///< the length that docs/benchmark.md promises something about
  std::string_view what;
};
[[nodiscard]] std::span<const SequenceKind> sequence_kinds();

/// @param name    one of sequence_kinds()
/// @param frames  >= 1. Another length cuts the sequence or lets it go on; its speeds stay. (Only
///                "demo" is stretched to it.)
/// @throws Error when the body cannot be touched as the sequence promises
[[nodiscard]] Sequence plan_sequence(std::string_view name, const DeskBody& body, int frames,
                                     std::uint64_t seed);

}  // namespace palpable

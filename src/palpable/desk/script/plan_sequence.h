/// @file
/// The list of sequences, and their plans; docs/benchmark.md states the properties of each.
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
  int frames;             ///< the length for which docs/benchmark.md states properties
  std::string_view what;  ///< description for users
};
[[nodiscard]] std::span<const SequenceKind> sequence_kinds();

/// @param name    one of sequence_kinds()
/// @param frames  >= 1. Another length than that of the list cuts off or continues the sequence
///                without changing its speeds; only "demo" is stretched instead
/// @throws Error when the body cannot be touched in the way of the sequence
[[nodiscard]] Sequence plan_sequence(std::string_view name, const DeskBody& body, int frames,
                                     std::uint64_t seed);

}  // namespace palpable

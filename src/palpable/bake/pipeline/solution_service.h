/// @file
/// Answers loads exactly, one after the other, for a live run (response/solution_messages.h).
#pragma once

#include "palpable/bake/describe/body_description.h"
#include "palpable/bake/pipeline/full_body.h"

#include <functional>
#include <memory>

namespace palpable {

/// A described body whose answers to loads are as good as they need be. @throws Error as
/// pose_body()
[[nodiscard]] std::unique_ptr<FullBody> exact_body(const BodyDescription& description);

/// Says that it is ready, then answers every load that comes until the input ends. What goes wrong
/// while the body is made is said instead.
/// @param make_body  takes seconds
/// @param in, out    file descriptors
/// @return false where what came is no load of this body, or the output is closed
bool serve_full_solutions(const std::function<std::unique_ptr<FullBody>()>& make_body, int in,
                          int out);

}  // namespace palpable

/// @file
/// Computes full-order solutions of loads, one after the other, for a live run
/// (response/solution_messages.h).
#pragma once

#include "palpable/bake/describe/body_description.h"
#include "palpable/bake/pipeline/full_body.h"

#include <functional>
#include <memory>

namespace palpable {

/// The full-order body of a description, with the tolerance of full-order solutions. @throws Error
/// as pose_body()
[[nodiscard]] std::unique_ptr<FullBody> exact_body(const BodyDescription& description);

/// Makes the body, sends that it is ready, then sends the solution of every load that arrives until
/// the input ends. If the body cannot be made, sends the reason and returns.
/// @param make_body  takes seconds
/// @param in, out    file descriptors
/// @return false when a message is not a load of this body, or the output is closed
bool serve_full_solutions(const std::function<std::unique_ptr<FullBody>()>& make_body, int in,
                          int out);

}  // namespace palpable

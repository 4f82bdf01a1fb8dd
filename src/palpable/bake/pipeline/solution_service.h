/// @file
/// Computes full-order solutions of loads, one after the other, for a live run
/// (response/solution_messages.h).
#pragma once

#include "palpable/bake/describe/body_description.h"
#include "palpable/bake/pipeline/full_body.h"
#include "palpable/common/reduced/reduced_body.h"

#include <functional>
#include <memory>
#include <string>

namespace palpable {

/// The full-order body of a description, with the tolerance of full-order solutions. @throws Error
/// as pose_body()
[[nodiscard]] std::unique_ptr<FullBody> exact_body(const BodyDescription& description);

/// Whether a description can be that of a body in a file: by the material that both state, their
/// size, which remeshing may change a little, and the length of their edges.
/// @return why it is another body's; empty where nothing speaks against it, or the file does not
/// say
[[nodiscard]] std::string other_body_text(const BodyDescription& description,
                                          const ReducedBody& body);

/// Makes the body, sends that it is ready, then sends the solution of every load that arrives until
/// the input ends. If the body cannot be made, sends the reason and returns.
/// @param make_body  takes seconds
/// @param in, out    file descriptors
/// @return false when a message is not a load of this body, or the output is closed
bool serve_full_solutions(const std::function<std::unique_ptr<FullBody>()>& make_body, int in,
                          int out);

}  // namespace palpable

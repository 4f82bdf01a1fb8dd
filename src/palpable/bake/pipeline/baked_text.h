/// @file
/// The result of a bake as text for the user.
#pragma once

#include "palpable/bake/pipeline/bake_body.h"

#include <string>

namespace palpable {

/// Errors against the number of modes, sites that do not reach the press, sizes, methods and their
/// errors, and the errors at held-out states.
[[nodiscard]] std::string text_of(const BakedBody& baked);

}  // namespace palpable

/// @file
/// What a bake has made, in lines for people.
#pragma once

#include "palpable/bake/pipeline/bake_body.h"

#include <string>

namespace palpable {

/// Errors against the number of modes, sites that fall short, sizes, methods and their errors, and
/// what was compared with states that the body was not made from.
[[nodiscard]] std::string text_of(const BakedBody& baked);

}  // namespace palpable

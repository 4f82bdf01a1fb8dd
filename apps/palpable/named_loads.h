/// @file
/// Loads given by a user as a point of the body and a force.
#pragma once

#include "palpable/common/reduced/loaded_body.h"

#include <string>
#include <vector>

namespace palpable::app {

/// Parses texts "X,Y,Z=F": m in the body's frame, N. @throws Error for another form,
/// and as load_at()
[[nodiscard]] std::vector<PlacedLoad> parse_loads(const ReducedBody& body,
                                                  const std::vector<std::string>& texts);

}  // namespace palpable::app

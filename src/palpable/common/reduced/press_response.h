/// @file
/// The response of a body to one load or several, computed offline for reports and other programs.
///
///   V  surface vertices
#pragma once

#include "palpable/common/reduced/loaded_body.h"

#include <optional>
#include <span>
#include <vector>

namespace palpable {

struct PressResponse {
  std::vector<double> depth;                ///< m, press depth of each load
  std::vector<float> displacement;          ///< (3V) m
  std::optional<double> largest_von_mises;  ///< Pa; not known under several loads
  double error = 0;  ///< relative L2 error of the displacement, the worst in the body file
};

/// The response to one load at a site comes from the separated fields, that to all other loads from
/// LoadedBody.
/// @param loads  at least one
/// @throws Error if the body has no response to these loads, with the loads that are possible
[[nodiscard]] PressResponse find_press_response(const ReducedBody& body,
                                                std::span<const PlacedLoad> loads);

}  // namespace palpable

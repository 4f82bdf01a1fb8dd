/// @file
/// What a body does under one load or several, offline: figures for people and other programs.
///
///   V  surface vertices
#pragma once

#include "palpable/common/reduced/loaded_body.h"

#include <optional>
#include <span>
#include <vector>

namespace palpable {

struct PressResponse {
  std::vector<double> depth;                ///< m, how far each load's place moves along it
  std::vector<float> displacement;          ///< (3V) m
  std::optional<double> largest_von_mises;  ///< Pa; not known under several loads
  double error = 0;  ///< of the displacement, relative L2, the worst that the body file states
};

/// One load at a site is answered by the separated fields, everything else by LoadedBody.
/// @param loads  at least one
/// @throws Error when the body does not answer these loads, with what it does answer
[[nodiscard]] PressResponse find_press_response(const ReducedBody& body,
                                                std::span<const PlacedLoad> loads);

}  // namespace palpable

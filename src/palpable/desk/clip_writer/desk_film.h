/// @file
/// The parts needed to film the synthetic desk: its representation of a body, the rig, the
/// renderer.
#pragma once

#include "palpable/common/reduced/reduced_body.h"
#include "palpable/desk/film/desk_renderer.h"
#include "palpable/desk/script/desk_body.h"
#include "palpable/desk/script/plan_sequence.h"
#include "palpable/live/calibrate/rectification.h"

#include <cstdint>
#include <limits>

namespace palpable {

/// Seeds are written to TOML files, whose integers are limited to 2^63 - 1.
inline constexpr std::uint64_t kLargestSeed = std::numeric_limits<std::int64_t>::max();

/// The skin and the sites of a reduced body.
[[nodiscard]] DeskBody desk_body(const ReducedBody& body);

/// A rig, its rectification, and a renderer for a sequence.
struct Film {
  StereoRig rig;
  RectifiedGeometry geometry;
  DeskRenderer renderer;
};
/// @throws Error when OpenGL is not available
[[nodiscard]] Film film_of(const Sequence& sequence);

}  // namespace palpable

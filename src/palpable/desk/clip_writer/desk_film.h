/// @file
/// What films the synthetic desk: the body as the desk knows it, the rig, its renderer.
#pragma once

#include "palpable/common/reduced/reduced_body.h"
#include "palpable/desk/film/desk_renderer.h"
#include "palpable/desk/script/desk_body.h"
#include "palpable/desk/script/plan_sequence.h"
#include "palpable/live/calibrate/rectification.h"

#include <cstdint>
#include <limits>

namespace palpable {

/// Seeds are noted in TOML files, whose whole numbers end here.
inline constexpr std::uint64_t kLargestSeed = std::numeric_limits<std::int64_t>::max();

/// The skin and the sites of a reduced body.
[[nodiscard]] DeskBody desk_body(const ReducedBody& body);

/// The rig, its rectification, and a renderer of a sequence.
struct Film {
  StereoRig rig;
  RectifiedGeometry geometry;
  DeskRenderer renderer;
};
/// @throws Error without OpenGL
[[nodiscard]] Film film_of(const Sequence& sequence);

}  // namespace palpable

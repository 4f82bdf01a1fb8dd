/// @file
/// A sequence of the synthetic desk as a folder of images and its truth; docs/benchmark.md lists
/// the files.
#pragma once

#include "palpable/base/progress.h"
#include "palpable/calibrate/rectification.h"
#include "palpable/film/desk_renderer.h"
#include "palpable/reduced/reduced_body.h"
#include "palpable/script/desk_body.h"
#include "palpable/script/plan_sequence.h"

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>

namespace palpable::app {

/// Seeds are noted in TOML files, whose whole numbers end here.
inline constexpr std::uint64_t kLargestSeed = std::numeric_limits<std::int64_t>::max();

/// Which sequence.
struct SequenceOrder {
  std::string name;  ///< one of sequence_kinds()
  int frames = 0;    ///< >= 1
  std::uint64_t seed = 1;
  std::string body_name;  ///< noted in the truth
  int threads = 0;        ///< that film, 1 or 2, with the same outcome; 0: what is quicker
};

/// Films `body` as ordered and writes frames/ and truth/ into `folder`, which must not exist or
/// must hold neither. @throws Error when the sequence cannot be planned for the body, when OpenGL
/// is not to be had, or when the folder cannot be written
void write_sequence(const ReducedBody& body, const SequenceOrder& order,
                    const std::filesystem::path& folder, const Progress& progress);

/// The body of sequences and benches unless told otherwise: the dense bunny if it was baked, else
/// the demo's. @throws Error when neither is there
[[nodiscard]] std::filesystem::path default_body();

/// What the desk wants to know of a body.
[[nodiscard]] DeskBody desk_body(const ReducedBody& body);

/// The rig, its rectification, and the renderer of a sequence. @throws Error without OpenGL
struct Film {
  StereoRig rig;
  RectifiedGeometry geometry;
  DeskRenderer renderer;
};
[[nodiscard]] Film film_of(const Sequence& sequence);

}  // namespace palpable::app

/// @file
/// The clip of the synthetic desk as a folder; what it holds is listed in synth.cpp.
#pragma once

#include "palpable/base/progress.h"
#include "palpable/reduced/reduced_body.h"

#include <cstdint>
#include <filesystem>

namespace palpable::app {

/// Films a finger that presses `body` and writes frames/ and truth/ into `folder`, which must not
/// exist or must hold neither. @throws Error when no path of the hand is found, when OpenGL is not
/// to be had, or when the folder cannot be written
void write_press_clip(const ReducedBody& body, int frames, std::uint64_t seed,
                      const std::filesystem::path& folder, const Progress& progress);

}  // namespace palpable::app

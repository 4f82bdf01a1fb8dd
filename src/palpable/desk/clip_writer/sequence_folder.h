/// @file
/// A sequence of the synthetic desk, filmed into a folder: frames/ as a camera gives them, and
/// truth/ beside them. docs/benchmark.md lists the files, clip_files has their formats.
#pragma once

#include "palpable/common/base/progress.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/common/reduced/reduced_body.h"

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace palpable {

/// Which sequence.
struct SequenceOrder {
  std::string name;  ///< one of sequence_kinds(), or "beams" (script/beams.h)
  int frames = 0;    ///< >= 1
  std::uint64_t seed = 1;
  std::string body_name;  ///< noted in the truth
  int threads = 0;        ///< that film, 1 or 2, with the same outcome; 0: what is quicker
};

/// One of a scene's bodies.
struct SequenceBody {
  const ReducedBody* body = nullptr;
  std::string name = {};
  Rigid3 scene_from_body = Rigid3::Identity();
};

/// Films a scene of several bodies. Hands press the first of them ("beams": the upper one); the
/// others stand about. What is true of each body lies in truth/bodies/NAME, as it lies in truth/ of
/// a film with one. @param bodies  names differ
void write_sequence(std::span<const SequenceBody> bodies, const SequenceOrder& order,
                    const std::filesystem::path& folder, const Progress& progress);

/// Films `reduced` as ordered and writes frames/ and truth/ into `folder`, which must not exist or
/// must hold neither; those of a film that was interrupted are filmed again. Nobody else may film
/// into it meanwhile. @throws Error when the sequence cannot be planned for the body, when OpenGL
/// is not to be had, or when the folder cannot be written
void write_sequence(const ReducedBody& reduced, const SequenceOrder& order,
                    const std::filesystem::path& folder, const Progress& progress);

}  // namespace palpable

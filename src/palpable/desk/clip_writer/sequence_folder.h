/// @file
/// Films a sequence of the synthetic desk into a folder: frames/ as a camera would deliver them,
/// and truth/ beside them. docs/benchmark.md lists the files; clip_files defines their formats.
#pragma once

#include "palpable/common/base/progress.h"
#include "palpable/common/geometry/rigid.h"
#include "palpable/common/reduced/reduced_body.h"

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace palpable {

/// Which sequence to film.
struct SequenceOrder {
  std::string name;  ///< one of sequence_kinds(), or "beams" (script/beams.h)
  int frames = 0;    ///< >= 1
  std::uint64_t seed = 1;
  std::string body_name;  ///< written to the truth
  int threads = 0;        ///< 1 or 2, with equal results; 0: whichever is faster
  /// The caller holds the lock of the folder (base/folder_lock.h), and a film in it is replaced.
  bool replaces = false;
};

/// One body of a scene.
struct SequenceBody {
  const ReducedBody* body = nullptr;
  std::string name = {};
  Rigid3 scene_from_body = Rigid3::Identity();
};

/// Films a scene of several bodies. Hands press the first of them ("beams": the upper one); the
/// others only stand beside it. The truth of each body is in truth/bodies/NAME, with the files that
/// truth/ has for a single body. @param bodies  with different names
void write_sequence(std::span<const SequenceBody> bodies, const SequenceOrder& order,
                    const std::filesystem::path& folder, const Progress& progress);

/// Films `reduced` as ordered and writes frames/ and truth/ into `folder`, which must not exist or
/// must hold neither; the remains of an interrupted film are replaced, by the names of its files:
/// what somebody else put there stays. The folder is locked during filming. @throws Error when the
/// sequence cannot be planned for the body, when OpenGL is not available, or when the folder cannot
/// be written
void write_sequence(const ReducedBody& reduced, const SequenceOrder& order,
                    const std::filesystem::path& folder, const Progress& progress);

}  // namespace palpable

/// @file
/// The clip of the synthetic desk that a live run plays: filmed once for a body, then kept.
#pragma once

#include "palpable/common/base/progress.h"
#include "palpable/common/reduced/reduced_body.h"

#include <filesystem>
#include <string>

namespace palpable {

struct KeptClipOrder {
  std::filesystem::path folder;     ///< of the clip
  std::filesystem::path body_file;  ///< its bytes say whether a clip that is there is of this body
  std::string version;              ///< of the program: another one films anew
  int frames = 300;
  std::string sequence = "demo";
};

/// The sequence, seed 1. The file made_for.txt says what a folder was filmed for, and that
/// it is whole: until it is, made_for.txt says that it is being filmed. A folder whose filming was
/// interrupted, or one of another body or version, is filmed again.
/// @return the folder of the images
/// @throws Error when the folder holds something else, or as write_sequence()
[[nodiscard]] std::filesystem::path kept_clip(const ReducedBody& body, const KeptClipOrder& order,
                                              const Progress& progress);

}  // namespace palpable

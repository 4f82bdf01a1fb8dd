/// @file
/// The clip of the synthetic desk that a live run plays: filmed once per body, then reused.
#pragma once

#include "palpable/common/base/progress.h"
#include "palpable/common/reduced/reduced_body.h"

#include <filesystem>
#include <string>

namespace palpable {

struct KeptClipOrder {
  std::filesystem::path folder;     ///< of the clip
  std::filesystem::path body_file;  ///< its checksum identifies the body of an existing clip
  std::string version;              ///< of the program; clips of other versions are filmed again
  int frames = 300;
  std::string sequence = "demo";
};

/// Films the sequence with seed 1 unless the folder already holds this clip. The file made_for.txt
/// in the folder names program version, sequence and body of a complete clip; while a clip is being
/// filmed it says so. A folder whose filming was interrupted, or that was filmed for another body
/// or version, is filmed again.
/// @return the folder of the images
/// @throws Error when the folder holds something else or the body file, or as write_sequence() does
[[nodiscard]] std::filesystem::path kept_clip(const ReducedBody& body, const KeptClipOrder& order,
                                              const Progress& progress);

}  // namespace palpable

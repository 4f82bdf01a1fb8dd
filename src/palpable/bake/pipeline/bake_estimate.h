/// @file
/// Time, memory and size of the file that a bake will take, said before it begins:
/// `palpable bake DESCRIPTION --estimate`.
///
/// What there is to do is counted (solves, passes over the elements, operations of products of
/// matrices), and each is multiplied by what it costs on this machine (bake_counts.h). So the
/// estimate follows the machine, the mesh and the number of threads. What cannot be counted
/// beforehand, such as the iterations of a path, are the constants at the top of bake_estimate.cpp,
/// with the bakes that they were measured on.
#pragma once

#include "palpable/bake/pipeline/bake_counts.h"
#include "palpable/common/base/json.h"

#include <filesystem>
#include <string>
#include <vector>

namespace palpable {

/// One stage of a bake.
struct BakeStage {
  std::string name;
  double cpu_seconds = 0;
  bool parallel = false;  ///< whether threads share it
};

struct BakeEstimate {
  /// The true figures of the bodies that ship with the program are between a half and twice these.
  static constexpr double kFactor = 2.0;

  int threads = 1;
  double seconds = 0;  ///< wall time, where nothing else keeps the machine busy
  double cpu_seconds = 0;
  double memory_bytes = 0;    ///< at most at any time
  double file_bytes = 0;      ///< of the body file; 0 for one part of a campaign (--shard)
  double snapshot_bytes = 0;  ///< of the folder of snapshots; 0 without a campaign
  std::vector<BakeStage> stages = {};
};

/// CPU seconds of each stage.
[[nodiscard]] std::vector<BakeStage> stages_of(const BakeCounts& counts, const BakeCosts& costs);

/// Largest memory at any time, bytes. @param threads  >= 1
[[nodiscard]] double memory_of(const BakeCounts& counts, int threads);

/// Size of the body file, bytes: the modes, the tables of touch and the skin.
[[nodiscard]] double file_bytes_of(const BakeCounts& counts);

/// @param threads  >= 1
[[nodiscard]] BakeEstimate estimate_of(const BakeCounts& counts, const BakeCosts& costs,
                                       int threads);

/// Three lines for people.
[[nodiscard]] std::string text_of(const BakeEstimate& estimate);

/// {"seconds", "cpu_seconds", "memory_bytes", "file_bytes", "snapshot_bytes", "threads", "factor",
/// "stages": {NAME: CPU seconds}}
[[nodiscard]] Json json_of(const BakeEstimate& estimate);

}  // namespace palpable

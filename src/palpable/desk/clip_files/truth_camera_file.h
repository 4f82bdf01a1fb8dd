/// @file
/// camera.toml of a truth: the camera and the depth unit for scoring, and the sequence and body
/// that were filmed. A folder without this file is no truth, so it is written last.
#pragma once

#include "palpable/common/geometry/camera.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace palpable {

struct TruthCamera {
  double frames_per_second = 0;         ///< > 0; "fps"
  double depth_unit = 0;                ///< > 0, m per count of depth/; "depth_unit_m"
  std::optional<PinholeCamera> camera;  ///< the rectified left camera at half size
  std::optional<double> baseline;       ///< m; "baseline_m"
  std::string sequence;                 ///< name
  std::optional<std::uint64_t> seed;    ///< of the sequence; at most 2^63 - 1
  std::string body;                     ///< name
};

/// @throws Error when the file cannot be written
/// @throws ContractViolation unless all values are known
void write_truth_camera(const std::filesystem::path& path, const TruthCamera& camera);

/// Only fps and depth_unit_m are required.
/// @throws Error naming file and line when one of the two is missing or not above 0, or when the
/// file is no TOML
[[nodiscard]] TruthCamera read_truth_camera(const std::filesystem::path& file);

}  // namespace palpable

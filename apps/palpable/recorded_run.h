/// @file
/// The data of a run that its recording has beside the frames: the bodies, their poses,
/// and the settings.
#pragma once

#include "apps/palpable/live_setup.h"
#include "palpable/common/base/json.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace palpable::app {

struct RecordedRun {
  struct Body {
    DescribedBody body;
    std::uint64_t checksum = 0;  ///< of the body file (base/checksum.h)
    Rigid3 world_from_body = Rigid3::Identity();
  };
  std::string version;          ///< of the program
  std::string source;           ///< name of the source that was played
  std::filesystem::path scene;  ///< empty: one body
  std::vector<Body> bodies;
  LiveOptions options;  ///< contact, paper, matcher, fixed_camera, press_static, refine
};

/// The data of a run that is about to begin.
/// @throws Error when a body's file cannot be read
[[nodiscard]] RecordedRun recorded_run(const LiveOptions& options, const LiveSetUp& setup);

[[nodiscard]] Json json_of_run(const RecordedRun& run);
/// @throws Error, without a file's name, when the JSON is invalid
[[nodiscard]] RecordedRun recorded_run_of(const Json& json);

/// Finds the body files: at their recorded paths, or among `elsewhere`. A file belongs to a body if
/// it has its checksum. @throws Error that names a body whose file is missing or different
void find_body_files(RecordedRun& run, const std::vector<std::string>& elsewhere);

}  // namespace palpable::app

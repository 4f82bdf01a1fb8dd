/// @file
/// What a recording says of the run that made it, beside its frames: which bodies stood where, and
/// how they were answered.
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
    std::uint64_t checksum = 0;  ///< of its file (base/file_checksum.h)
    Rigid3 world_from_body = Rigid3::Identity();
  };
  std::string version;          ///< of the program
  std::string source;           ///< what was played
  std::filesystem::path scene;  ///< empty: one body
  std::vector<Body> bodies;
  LiveOptions options;  ///< contact, paper, matcher, fixed_camera, press_static, refine
};

/// Of a run that is about to begin.
/// @throws Error when a body's file cannot be read
[[nodiscard]] RecordedRun recorded_run(const LiveOptions& options, const LiveSetUp& setup);

[[nodiscard]] Json json_of_run(const RecordedRun& run);
/// @throws Error, without a file's name, when it is none
[[nodiscard]] RecordedRun recorded_run_of(const Json& json);

/// The files of the bodies: where they lay, or one of `elsewhere`. A file is taken for a body's
/// when it has its checksum. @throws Error that names a body whose file is not there, or another
/// one
void find_body_files(RecordedRun& run, const std::vector<std::string>& elsewhere);

}  // namespace palpable::app

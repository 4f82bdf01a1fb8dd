/// @file
/// A run together with all that it was set up from: into a recording, and from it again.
#pragma once

#include "palpable/common/base/json.h"
#include "palpable/common/response/touchable_body.h"
#include "palpable/desk/clip_files/scene_files.h"
#include "palpable/live/play/run_options.h"
#include "palpable/live/player/live_run.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace palpable {

/// A run, and the descriptions of its bodies in their order.
struct LiveSetUp {
  LiveRun run;
  std::vector<DescribedBody> bodies;
  LiveSettings settings = {};  ///< used to open the run; not of a replay
  RunOptions options = {};
  std::filesystem::path scene = {};  ///< the scene's file; empty: one body
  std::string version = {};          ///< of the program, for recordings
};

/// Reads one body from its file, at its scale and its parameters' values.
/// @param contact, friction  as in RunOptions; without a friction there, that of the scene counts,
///        then that of the body file. @throws Error
[[nodiscard]] TouchableBody read_live_body(const DescribedBody& wanted, const std::string& contact,
                                           std::optional<double> friction = {});

/// What a recording has beside the frames.
struct RecordedRun {
  struct Body {
    DescribedBody body;
    std::uint64_t checksum = 0;  ///< of the body file (base/file_checksum.h)
    Rigid3 world_from_body = Rigid3::Identity();
  };
  std::string version;          ///< of the program
  std::string source;           ///< name of the source that was played
  std::filesystem::path scene;  ///< empty: one body
  RunOptions options;
  std::vector<Body> bodies;
};

/// The JSON of a run that is about to begin, which recorded_run_of() reads.
/// @throws Error when a body's file cannot be read
[[nodiscard]] Json json_of_run(const LiveSetUp& setup);
/// @throws Error, without a file's name, when the JSON is invalid
[[nodiscard]] RecordedRun recorded_run_of(const Json& json);

/// Finds the body files: at their recorded paths, or among `elsewhere`. A file belongs to a body if
/// it has its checksum. @throws Error that names a body whose file is missing or different
void find_body_files(RecordedRun& run, const std::vector<std::string>& elsewhere);

/// A run that plays the recording again. Full-order solutions come from the recording, too.
/// @param run      after find_body_files()
/// @param file     the recording
/// @param threads  of the whole run; 0: one for each processor
/// @param at_pace  play at the recorded pace or slower; else as fast as possible
/// @throws Error
[[nodiscard]] LiveSetUp set_up_replay(const RecordedRun& run, const std::filesystem::path& file,
                                      int threads, bool at_pace);

}  // namespace palpable

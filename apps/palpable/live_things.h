/// @file
/// `palpable live` without a camera: what presses comes as lines of JSON (docs/hands.md).
#pragma once

#include "apps/common/command_line.h"
#include "apps/palpable/live_options.h"
#include "palpable/live/play/things_play.h"

#include <string>
#include <vector>

namespace palpable::app {

/// Whether --source names a hands file, *.jsonl, or is kSocketSource.
[[nodiscard]] bool is_things_source(const std::string& source);

/// @throws Error for a table (.csv, .tsv), which is to become a hands file first
void refuse_table_source(const std::string& source);

/// @param given  the options of the call
/// @throws Error that names an option which means nothing without a camera, or one that is missing
void refuse_camera_options(const LiveOptions& options, const PlayOptions& play,
                           const std::vector<Command::GivenOption>& given);

/// Reads the bodies and determines their poses in the world in which the lines are given: --place,
/// else the origin, upright along Z; those of a scene file beside each other from there.
/// @throws Error for every failure
[[nodiscard]] ThingsSetUp set_up_things(const LiveOptions& options);

}  // namespace palpable::app

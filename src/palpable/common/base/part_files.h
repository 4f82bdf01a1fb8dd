/// @file
/// Names of files that are being written: a file has such a name until it is complete. Several
/// processes on several machines may write the same file, each under its own name.
#pragma once

#include <string>
#include <string_view>

namespace palpable {

/// ".part-HOST-PID", with which the names of this process's unfinished files end.
[[nodiscard]] std::string own_part_suffix();

/// Whether the process that writes a file of this name still runs on this machine.
[[nodiscard]] bool is_part_of_running_process(std::string_view name);

}  // namespace palpable

/// @file
/// Files that grow under another name until they are whole, where several processes on several
/// machines may write the same one.
#pragma once

#include <string>
#include <string_view>

namespace palpable {

/// ".part-HOST-PID", of this process: what the names of its growing files end with.
[[nodiscard]] std::string own_part_suffix();

/// Whether a file of this name still grows, on this machine.
[[nodiscard]] bool is_part_of_running_process(std::string_view name);

}  // namespace palpable

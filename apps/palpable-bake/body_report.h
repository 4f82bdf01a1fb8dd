/// @file
/// What bake and reduce say about the body that they made, and the options that they share.
#pragma once

#include "palpable/bake/describe/body_description.h"
#include "palpable/bake/pipeline/bake_body.h"
#include "palpable/common/body_file/body_file.h"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace palpable::app {

class Command;

/// What goes into a body file beside what its description says: --volume, --float16.
struct FileOptions {
  bool volume = false, float16 = false;

  [[nodiscard]] ModeStorage storage() const {
    return float16 ? ModeStorage::kFloat16 : ModeStorage::kFloat32;
  }
};

/// @param options  outlives `command`
void add_file_options(Command command, FileOptions& options);

/// The first line of what takes minutes: name and size. A size that nobody touches is remarked on,
/// on stderr, with the unit that is likely.
void print_size(const BodyDescription& description);

/// Errors against the number of modes, sites that fall short, sizes, and the file.
/// @param seconds  since the command began
void print_body_report(const BakedBody& baked, const std::string& output, double seconds);

/// "ears=0.5" each, as after --at. @throws Error for another form
[[nodiscard]] std::map<std::string, double> parse_values(const std::vector<std::string>& texts);

}  // namespace palpable::app

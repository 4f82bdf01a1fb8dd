/// @file
/// Printed results of bake and reduce, and their common options.
#pragma once

#include "palpable/bake/describe/body_description.h"
#include "palpable/bake/pipeline/bake_body.h"
#include "palpable/common/base/json.h"
#include "palpable/common/body_file/body_file.h"

#include <filesystem>
#include <string>
#include <vector>

namespace palpable::app {

class Command;

/// Content of a body file beyond its description: --volume, --float16.
struct FileOptions {
  bool volume = false, float16 = false;

  [[nodiscard]] ModeStorage storage() const {
    return float16 ? ModeStorage::kFloat16 : ModeStorage::kFloat32;
  }
};

/// @param options  must outlive `command`
void add_file_options(Command command, FileOptions& options);

/// Adds --overwrite: replace a body that has tables of touch by one without.
void add_overwrite(Command command, bool& overwrite);

/// Prints the body's name and size before work that takes minutes, and warnings on stderr: of an
/// implausible size with the probable unit, of cavities that a wrap fills, of materials
/// (material_warnings.h).
void print_size(const BodyDescription& description);

/// The warnings of material_warnings.h, on stderr.
void print_material_warnings(const BodyDescription& description);

/// A displacement in mm: three decimals, or as many digits where those would be 0.000.
[[nodiscard]] std::string millimetres(double metres);

/// Prints errors for each number of modes, sites with too large errors, sizes, and the file.
/// @param seconds  since the command began
void print_body_report(const BakedBody& baked, const std::string& output, double seconds);

/// The same as JSON: what `palpable inspect --json` prints of the file, and the cost.
[[nodiscard]] Json body_report(const BakedBody& baked, const std::string& output, double seconds);

/// Adds --set NAME=VALUE for the one value of a parameter that a body file shall hold.
void add_value_option(Command command, std::vector<std::string>& texts);

}  // namespace palpable::app

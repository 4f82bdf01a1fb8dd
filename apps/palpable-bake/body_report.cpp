#include "apps/palpable-bake/body_report.h"

#include "apps/common/command_line.h"
#include "apps/common/printing.h"
#include "palpable/bake/describe/body_mesh.h"
#include "palpable/bake/describe/body_size.h"
#include "palpable/bake/describe/material_warnings.h"
#include "palpable/bake/pipeline/baked_text.h"
#include "palpable/common/base/progress.h"
#include "palpable/common/base/text_numbers.h"
#include "palpable/common/base/this_machine.h"
#include "palpable/common/body_file/body_facts.h"
#include "palpable/common/geometry/size_text.h"

#include <fmt/core.h>

#include <cmath>
#include <system_error>

namespace palpable::app {

void add_file_options(Command command, FileOptions& options) {
  command.add_flag("--volume", options.volume,
                   "Keep all nodes and elements, which palpable export can write, not only the "
                   "boundary, which the live half draws");
  command.add_flag("--float16", options.float16,
                   "Keep modes in half precision: half the bytes; the loss is printed");
}

void add_overwrite(Command command, bool& overwrite) {
  command.add_flag("--overwrite", overwrite,
                   "Replace a finished body by one that has less, such as one without tables of "
                   "touch");
}

void print_size(const BodyDescription& description) {
  std::string repair;
  const Eigen::Vector3d size = size_of_body(description, &repair);
  print_note("{}: {}", description.name, size_text(size));
  if (!repair.empty()) print_note("{}: {}", description.shape.file.string(), repair);
  if (const auto warning = size_warning(description.shape, size)) {
    fmt::print(stderr, "warning: {}\n", *warning);
  }
  if (const auto warning = wrap_warning(description.shape)) {
    fmt::print(stderr, "warning: {}\n", *warning);
  }
  print_material_warnings(description);
}

void print_material_warnings(const BodyDescription& description) {
  for (const std::string& warning : material_warnings(description)) {
    fmt::print(stderr, "warning: {}\n", warning);
  }
}

std::string millimetres(double metres) {
  const double mm = 1e3 * metres;
  return mm == 0.0 || std::abs(mm) >= 0.01 ? fmt::format("{:.3f} mm", mm)
                                           : fmt::format("{:.3g} mm", mm);
}

void print_body_report(const BakedBody& baked, const std::string& output, double seconds) {
  print_text("{}", text_of(baked));
  std::error_code code;
  print_text(
      "{}: {:.1f} MB in {}, with at most {:.0f} MB of memory; look at it with: palpable view {}\n",
      output, static_cast<double>(std::filesystem::file_size(output, code)) / 1e6,
      duration_text(seconds), peak_memory() / 1e6, output);
}

Json body_report(const BakedBody& baked, const std::string& output, double seconds) {
  Json result = json_of(baked.body);
  std::error_code code;
  result["file"] = output;
  result["file_bytes"] = std::filesystem::file_size(output, code);
  result["seconds"] = seconds;
  result["peak_memory_bytes"] = peak_memory();
  return result;
}

void add_value_option(Command command, std::vector<std::string>& texts) {
  command
      .add_option("--set", texts, "The one value of a further parameter that the body file holds")
      .type_name("NAME=VALUE")
      .further_words(has_equals_sign)
      .default_is("the parameter stays free");
}

}  // namespace palpable::app

#include "apps/palpable-bake/body_report.h"

#include "apps/common/command_line.h"
#include "palpable/bake/describe/body_mesh.h"
#include "palpable/bake/describe/body_size.h"
#include "palpable/bake/pipeline/baked_text.h"
#include "palpable/common/base/progress.h"
#include "palpable/common/base/text_numbers.h"
#include "palpable/common/base/this_machine.h"
#include "palpable/common/geometry/size_text.h"

#include <fmt/core.h>

#include <cstdio>
#include <system_error>

namespace palpable::app {

void add_file_options(Command command, FileOptions& options) {
  command.add_flag("--volume", options.volume,
                   "Keep all nodes and elements, which palpable export can write, not only the "
                   "boundary, which the live half draws");
  command.add_flag("--float16", options.float16,
                   "Keep modes in half precision: half the bytes; the loss is printed");
}

void print_size(const BodyDescription& description) {
  const Eigen::Vector3d size = size_of_body(description);
  fmt::print("{}: {}\n", description.name, size_text(size));
  std::fflush(stdout);  // before the progress bar
  if (const auto warning = size_warning(description.shape, size)) {
    fmt::print(stderr, "warning: {}\n", *warning);
  }
  if (const auto warning = wrap_warning(description.shape)) {
    fmt::print(stderr, "warning: {}\n", *warning);
  }
}

void print_body_report(const BakedBody& baked, const std::string& output, double seconds) {
  fmt::print("{}", text_of(baked));
  std::error_code code;
  fmt::print(
      "{}: {:.1f} MB in {}, with at most {:.0f} MB of memory; look at it with: palpable view {}\n",
      output, static_cast<double>(std::filesystem::file_size(output, code)) / 1e6,
      duration_text(seconds), peak_memory() / 1e6, output);
}

std::map<std::string, double> parse_values(const std::vector<std::string>& texts) {
  return parse_settings(texts, "--at", "one of its values, such as ears=0.5");
}

}  // namespace palpable::app

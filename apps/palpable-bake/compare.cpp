// palpable compare bunny.snapshots bunny.palpable: charts the errors of reduction methods and of
// body files against their numbers of modes.

#include "apps/common/command_line.h"
#include "apps/common/printing.h"
#include "apps/common/progress_bar.h"
#include "apps/palpable-bake/body_report.h"
#include "apps/palpable-bake/commands.h"
#include "palpable/bake/exchange/web_page.h"
#include "palpable/bake/pipeline/compare_methods.h"
#include "palpable/bake/separate/reduction.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/base/output_name.h"
#include "palpable/common/base/text_numbers.h"
#include "palpable/common/base/this_machine.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;

struct CompareOptions {
  std::vector<std::string> inputs, set;
  std::string output = "compare.html";
  CompareSettings settings;
  bool json = false;
};

// Adds the bodies first, in the chart's order.
void add_inputs(const CompareOptions& options, MethodPage& page) {
  CompareSettings settings = options.settings;
  settings.at = parse_settings(options.set);
  std::vector<SnapshotStore> stores;
  std::vector<fs::path> bodies;
  for (const std::string& input : options.inputs) {
    if (fs::is_directory(input)) {
      stores.push_back(SnapshotStore::open(input));
    } else {
      bodies.emplace_back(input);
    }
  }
  if (stores.empty() && !settings.at.empty()) {
    throw Error(fmt::format("--set {}: is of snapshots, and there are none among the inputs",
                            options.set.front()));
  }
  for (const fs::path& body : bodies) add_body(body, page);
  for (const SnapshotStore& store : stores) {
    const std::string prefix =
        stores.size() > 1 ? store.folder().filename().string() + ": " : std::string();
    ProgressBar bar;
    add_store(store, prefix, settings, page, bar.progress());
  }
  page.lead = fmt::format(
      "Error of the solved states for a given number of modes or bytes{}.",
      stores.empty() ? std::string()
                     : fmt::format("; each method goes on until {:.3g} of all snapshots together "
                                   "(per-site: of each site's) is left",
                                   settings.tolerance));
}

Json json_of_lines(const std::vector<MethodLine>& lines) {
  Json list = Json::array();
  for (const MethodLine& line : lines) {
    list.push_back({{"method", line.name},
                    {"is_body_file", line.is_body},
                    {"modes", line.modes},
                    {"bytes", line.bytes},
                    {"pooled_error", line.pooled},
                    {"median_error", line.median},
                    {"worst_error", line.worst},
                    {"seconds", line.seconds}});
  }
  return list;
}

void compare(const CompareOptions& options, const std::string& command_line) {
  const fs::path table = table_beside(options.output);
  const std::vector<fs::path> inputs(options.inputs.begin(), options.inputs.end());
  for (const fs::path& output : {fs::path(options.output), table}) {
    guard_output_file(output, inputs);
  }
  require_ending(options.output, {".html", ".htm"}, "an HTML page");
  MethodPage page;
  page.title = "Methods of reduction, side by side";
  add_inputs(options, page);
  page.provenance.emplace_back("program", std::string("palpable ") + PALPABLE_VERSION);
  page.provenance.emplace_back("command line", command_line);
  page.provenance.emplace_back("computed on",
                               fmt::format("{}, {}", processor_name(), date_today()));
  page.footer = fmt::format("Written by palpable {} on {}; the same numbers are in {}.",
                            PALPABLE_VERSION, date_today(), table.filename().string());
  write_whole_file(options.output, method_page(page));
  write_whole_file(table, method_table(page));
  if (options.json) {
    print_json({{"page", options.output},
                {"table", table.string()},
                {"displacement", json_of_lines(page.displacement)},
                {"stress", json_of_lines(page.stress)}});
    return;
  }
  print_text("{}", method_text(page));
  print_text("{}: opens in any browser, loads nothing; the same numbers: {}\n", options.output,
             table.string());
}

}  // namespace

void add_compare(Command app, const std::string& command_line) {
  const auto options = std::make_shared<CompareOptions>();
  Command command = app.add_subcommand(
      "compare",
      "Put all methods of reduction, and body files, on one chart of errors: an HTML page");
  command
      .add_option("inputs", options->inputs,
                  "Folders of snapshots: every method is tried on them; body files: as they are")
      .required()
      .type_name("DIR|FILE");
  command
      .add_option("-o,--out", options->output,
                  "Page to write, NAME.html; the numbers go to NAME.csv")
      .show_default();
  command
      .add_option("--method", options->settings.methods,
                  "Only these methods. Not sparse-pgd, which learns from a part of the snapshots: "
                  "bring its "
                  "body file")
      .one_of(method_names())
      .type_name("METHOD")
      .default_is("all");
  command
      .add_option("--tolerance", options->settings.tolerance,
                  "Relative error at which each method stops, all snapshots together (per-site: "
                  "those of each site)")
      .in_range(1e-6, 0.999)
      .show_default();
  command
      .add_option("--max-modes", options->settings.max_modes,
                  "Number of modes at which each method stops at the latest")
      .in_range(1, 100000)
      .show_default();
  command
      .add_option("--set", options->set,
                  "The value of a further parameter whose snapshots are compared")
      .type_name("NAME=VALUE")
      .further_words(has_equals_sign)
      .default_is("the middle one");
  command.add_json(options->json);
  command.footer("Example: palpable compare bunny.snapshots bunny.palpable -o compare.html");
  command.callback([options, command_line] { compare(*options, command_line); });
}

}  // namespace palpable::app

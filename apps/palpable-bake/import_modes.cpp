// palpable import-modes theirs.pxdmf -o theirs.palpable

#include "apps/common/command_line.h"
#include "apps/common/printing.h"
#include "apps/palpable-bake/body_report.h"
#include "apps/palpable-bake/commands.h"
#include "palpable/bake/exchange/foreign_modes.h"
#include "palpable/bake/pipeline/bake_to_file.h"
#include "palpable/bake/pipeline/import_figures.h"
#include "palpable/common/base/file_format.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/base/output_name.h"
#include "palpable/common/body_file/body_facts.h"
#include "palpable/common/body_file/body_file.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>

namespace palpable::app {
namespace {

struct ImportModesOptions {
  std::string input, output;
  bool json = false;
  bool overwrite = false;
  ImportSettings settings;
};

void import_modes(ImportModesOptions options, const std::string& command_line) {
  guard_output_file(options.output, {options.input});
  require_ending(options.output, {kBodyFileEnding}, "a body file");
  guard_format(options.output, FileFormat::kBody);
  if (!options.overwrite) expect_no_lost_tables(options.output);
  const bool folder = std::filesystem::is_directory(options.input);
  const ForeignModes modes = folder ? read_numpy_modes(options.input) : read_pxdmf(options.input);
  options.settings.source = options.input;
  options.settings.name = std::filesystem::path(options.output).stem().string();
  options.settings.provenance = {
      .modes = fmt::format("{} ({})", options.input, folder ? "NumPy" : "PXDMF"),
      .errors = "not known: the modes of another program",
      .program = std::string("palpable ") + PALPABLE_VERSION,
      .command_line = command_line};
  const ReducedBody body = body_of_modes(modes, options.settings);
  const ImportedFigures figures = figures_of(body, !modes.site_vertices.empty());
  for (const std::string& warning : import_warnings(figures)) {
    fmt::print(stderr, "warning: {}: {}\n", options.input, warning);
  }
  write_body_file(options.output, body);
  if (options.json) {
    print_json(json_of(body));
    return;
  }
  print_text(
      "{}: {} sites, {} levels, {} modes of displacement, {} of stress; press it with: "
      "palpable view {}\n",
      options.output, body.sites.size(), body.levels().size() - 1, body.displacement.mode_count(),
      modes.stress ? body.stress.mode_count() : 0, options.output);
  print_text("{}\n", figures_text(figures));
}

}  // namespace

void add_import_modes(Command app, const std::string& command_line) {
  const auto options = std::make_shared<ImportModesOptions>();
  Command command = app.add_subcommand(
      "import-modes", "Make a body file from another program's separated representation");
  command.add_option("input", options->input, "A .pxdmf file, or a folder of NumPy arrays")
      .required()
      .existing_path()
      .type_name("FILE|DIR");
  command.add_option("-o,--out", options->output, "Body file to write")
      .type_name("FILE.palpable")
      .required();
  command
      .add_option("--site-parameter", options->settings.site,
                  "The parameter that is the place of the touch")
      .show_default();
  command.add_option("--level-parameter", options->settings.level, "The parameter that is the load")
      .show_default();
  add_overwrite(command, options->overwrite);
  command.add_json(options->json);
  command.footer(
      "docs/exchange.md says what is read, and how what a file does not say is found.\n"
      "Example: palpable import-modes theirs.pxdmf --level-parameter force -o theirs.palpable");
  command.callback([options, command_line] { import_modes(*options, command_line); });
}

}  // namespace palpable::app

// palpable export bunny.palpable --to pxdmf -o bunny.pxdmf

#include "apps/common/command_line.h"
#include "apps/common/printing.h"
#include "apps/palpable-bake/commands.h"
#include "palpable/bake/campaign/snapshot_store.h"
#include "palpable/bake/exchange/foreign_modes.h"
#include "palpable/bake/exchange/press_series.h"
#include "palpable/bake/pipeline/export_store.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/npy_file.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/base/text_numbers.h"
#include "palpable/common/body_file/body_file.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;

struct ExportOptions {
  std::string input, to, output;
  int site = -1;  // -1: all
  std::vector<std::string> set;
};

// The chosen site; empty: all sites.
std::optional<int> one_site(const ExportOptions& options) {
  return options.site < 0 ? std::nullopt : std::optional(options.site);
}

void export_body(const ExportOptions& options) {
  if (options.to == "numpy" || options.to == "pxdmf") {  // with all parameters
    const ForeignModes modes = modes_of_body(value_or_throw(read_body_file(options.input)));
    options.to == "numpy" ? write_numpy_modes(options.output, modes)
                          : write_pxdmf(options.output, modes);
    return;
  }
  const ReducedBody body =
      value_or_throw(read_pressable_body(options.input, parse_settings(options.set)));
  options.to == "vtu" ? write_vtu_series(options.output, body, one_site(options))
                      : write_xdmf_series(options.output, body, one_site(options));
}

void export_snapshots(const ExportOptions& options) {
  const SnapshotStore store = SnapshotStore::open(options.input);
  if (options.to == "pxdmf") {
    throw Error(
        fmt::format("{}: snapshots have no modes; make a body of them first (palpable "
                    "reduce)",
                    options.input));
  }
  if (options.to == "xdmf") {
    throw Error(fmt::format("{}: is XDMF already; open {} in ParaView", options.input,
                            (store.folder() / "campaign.xdmf").string()));
  }
  const int written = options.to == "vtu"
                          ? export_store_to_vtu(store, one_site(options), options.output)
                          : export_store_to_numpy(store, one_site(options), options.output);
  if (written == 0) throw Error(fmt::format("--site {}: there is no such site", options.site));
}

void export_as_asked(const ExportOptions& options) {
  if (options.to == "vtu" || options.to == "numpy") {
    guard_output_folder(options.output, {options.input});
  } else {  // the arrays go to a file beside it
    guard_output_file(options.output, {options.input});
    guard_output_file(options.output + ".h5", {options.input});
  }
  fs::is_directory(options.input) ? export_snapshots(options) : export_body(options);
  print_text("{}\n", options.output);
}

}  // namespace

void add_export(Command app) {
  const auto options = std::make_shared<ExportOptions>();
  Command command =
      app.add_subcommand("export", "Write a body or its snapshots for other programs");
  command.add_option("input", options->input, "A body file, or a folder of snapshots")
      .required()
      .type_name("FILE|DIR");
  command
      .add_option(
          "--to", options->to,
          "vtu: a folder, one file per site and level; xdmf: one file of the same; numpy: a "
          "folder of arrays, the modes (of a store: the snapshots); pxdmf: the modes as "
          "other PGD programs read them")
      .required()
      .one_of({"vtu", "xdmf", "numpy", "pxdmf"});
  command.add_option("-o,--out", options->output, "File or folder to write")
      .required()
      .type_name("FILE|DIR");
  command.add_option("--site", options->site, "vtu, xdmf: this site only")
      .not_negative()
      .default_is("all");
  add_set_option(command, options->set);
  command.footer(
      "docs/exchange.md describes the files.\n"
      "Example: palpable export bunny.palpable --to vtu --site 4 -o bunny_site_4");
  command.callback([options] { export_as_asked(*options); });
}

}  // namespace palpable::app

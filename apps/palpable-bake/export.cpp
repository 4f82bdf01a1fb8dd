// palpable export bunny.palpable --to pxdmf -o bunny.pxdmf

#include "apps/common/command_line.h"
#include "apps/common/export_options.h"
#include "apps/common/interruption.h"
#include "apps/common/printing.h"
#include "apps/palpable-bake/commands.h"
#include "palpable/bake/campaign/set_aside.h"
#include "palpable/bake/campaign/snapshot_store.h"
#include "palpable/bake/exchange/foreign_modes.h"
#include "palpable/bake/exchange/press_series.h"
#include "palpable/bake/pipeline/export_store.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/file_format.h"
#include "palpable/common/base/npy_file.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/base/output_name.h"
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
  std::string input, to, output, holds_all = "auto";
  int site = -1;  // -1: all
  std::vector<std::string> set;
};

// The chosen site; empty: all sites.
std::optional<int> one_site(const ExportOptions& options) {
  return options.site < 0 ? std::nullopt : std::optional(options.site);
}

bool writes_folder(const ExportOptions& options) {
  return options.to == "vtu" || options.to == "numpy";
}

// The modes, of all values of all parameters or, with --set, of the given ones.
void export_modes(const ExportOptions& options) {
  if (options.site >= 0) {
    throw Error(fmt::format(
        "--site {}: the modes that --to {} writes are of all sites together; --to vtu and --to "
        "xdmf write one site",
        options.site, options.to));
  }
  const ForeignModes modes = modes_of_body(
      options.set.empty()
          ? value_or_throw(read_body_file(options.input))
          : value_or_throw(read_pressable_body(options.input, parse_settings(options.set))));
  options.to == "numpy" ? write_numpy_modes(options.output, modes)
                        : write_pxdmf(options.output, modes);
}

void export_body(const ExportOptions& options) {
  if (options.to == "numpy" || options.to == "pxdmf") {
    export_modes(options);
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
  const WantedUnits wanted{one_site(options), parse_settings(options.set)};
  options.to == "vtu" ? export_store_to_vtu(store, wanted, options.output)
                      : export_store_to_numpy(store, wanted, options.output);
}

// Refuses a folder in which files have the endings of what is written, and are something else.
void refuse_among_others(const ExportOptions& options) {
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(options.output, error)) {
    const fs::path ending = entry.path().extension();
    if (options.to == "numpy" && ending == ".npy") guard_format(entry.path(), FileFormat::kNpy);
    if (options.to == "vtu" && (ending == ".vtu" || ending == ".pvd")) {
      guard_format(entry.path(), FileFormat::kXml);
    }
  }
}

void check_output(const ExportOptions& options) {
  if (writes_folder(options)) {
    guard_output_folder(options.output, {options.input});
    require_folder_name(options.output);
    refuse_campaign_folder(options.output);
    refuse_among_others(options);
    return;
  }
  guard_output_file(options.output, {options.input});
  if (options.to == "xdmf") {
    require_ending(options.output, {".xdmf", ".xmf"}, "an XDMF file");
  } else {
    require_ending(options.output, {".pxdmf"}, "a PXDMF file");
  }
  guard_output_file(options.output + ".h5", {options.input});  // the arrays
  guard_format(options.output, FileFormat::kXml);
  guard_format(options.output + ".h5", FileFormat::kHdf5);
}

void export_as_asked(const ExportOptions& options) {
  if (options.to == "web" || options.to == "page") {
    throw Error(
        fmt::format("--to {0}: palpable writes it, without palpable-bake: palpable export {1} "
                    "--to {0} -o {2}",
                    options.to, quoted_for_shell(options.input), quoted_for_shell(options.output)));
  }
  if (options.holds_all != "auto") {
    throw Error(fmt::format("--inline is for --to page; --to {} has no page", options.to));
  }
  check_output(options);
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
          "other PGD programs read them; web: a body as one file that a page fetches; "
          "page: a page in which bodies are pressed")
      .required()
      .one_of({"vtu", "xdmf", "numpy", "pxdmf", "web", "page"});
  command.add_option("-o,--out", options->output, "File or folder to write")
      .required()
      .type_name("FILE|DIR");
  command.add_option("--site", options->site, "vtu, xdmf, and snapshots: this site only")
      .not_negative()
      .default_is("all");
  add_set_option(command, options->set);
  add_inline_option(command, options->holds_all);
  command.footer(
      "docs/exchange.md describes the files.\n"
      "Example: palpable export bunny.palpable --to vtu --site 4 -o bunny_site_4");
  command.callback([options] { export_as_asked(*options); });
}

}  // namespace palpable::app

// palpable import-snapshots FOLDER --manifest runs.toml -o bunny.snapshots

#include "palpable/campaign/import_snapshots.h"

#include "apps/common/command_line.h"
#include "apps/common/progress_bar.h"
#include "apps/palpable-bake/commands.h"
#include "palpable/base/output_file.h"

#include <fmt/format.h>

#include <memory>
#include <string>

namespace palpable::app {
namespace {

struct Options {
  std::string folder;
  std::string manifest;
  std::string output;
};

void import(const Options& options) {
  guard_output_folder(options.output, {options.folder, options.manifest});
  const ImportManifest manifest = read_import_manifest(options.manifest);
  ProgressBar bar;
  const SnapshotStore store =
      import_snapshots(options.folder, manifest, options.output, bar.progress());
  bar.finish();
  std::string fields;
  for (const StoredField& field : store.content().fields) fields += " " + field.name;
  fmt::print("{}: {} sites x {} levels,{}; make a body of them with: palpable reduce {} -o FILE\n",
             options.output, store.content().unit_count(), store.content().level_count(), fields,
             options.output);
}

}  // namespace

void add_import_snapshots(Command app) {
  const auto options = std::make_shared<Options>();
  Command command = app.add_subcommand(
      "import-snapshots", "Take over what another solver has computed (docs/snapshots.md)");
  command.add_option("folder", options->folder, "Folder with the files of the other solver")
      .required()
      .existing_folder()
      .type_name("FOLDER");
  command
      .add_option("--manifest", options->manifest,
                  "Text that says which file is which snapshot (docs/snapshots.md)")
      .required()
      .type_name("FILE.toml");
  command.add_option("-o,--out", options->output, "Folder of snapshots to write")
      .required()
      .type_name("FOLDER");
  command.footer("Example: palpable import-snapshots runs --manifest runs.toml -o bunny.snapshots");
  command.callback([options] { import(*options); });
}

}  // namespace palpable::app

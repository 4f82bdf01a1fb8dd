// palpable import-snapshots FOLDER --manifest runs.toml -o bunny.snapshots

#include "palpable/bake/campaign/import_snapshots.h"

#include "apps/common/command_line.h"
#include "apps/common/printing.h"
#include "apps/common/progress_bar.h"
#include "apps/palpable-bake/commands.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/base/output_name.h"

#include <fmt/format.h>

#include <memory>
#include <string>

namespace palpable::app {
namespace {

struct ImportSnapshotsOptions {
  std::string folder;
  std::string manifest;
  std::string output;
  bool json = false;
};

void take_over_snapshots(const ImportSnapshotsOptions& options) {
  require_folder_name(options.output);
  guard_output_folder(options.output, {options.folder, options.manifest});
  const ImportManifest manifest = read_import_manifest(options.manifest);
  ProgressBar bar;
  const auto [store, aside, stress] =
      import_snapshots(options.folder, manifest, options.output, bar.progress());
  bar.finish();
  if (stress.is_warning) fmt::print(stderr, "warning: {}: {}\n", options.manifest, stress.text);
  if (options.json) {
    Json names = Json::array();
    for (const StoredField& field : store.content().fields) names.push_back(field.name);
    print_json({{"folder", options.output},
                {"sites", store.content().unit_count()},
                {"levels", store.content().level_count()},
                {"fields", std::move(names)}});
    return;
  }
  std::string fields;
  for (const StoredField& field : store.content().fields) fields += " " + field.name;
  print_text("{}: {} sites x {} levels,{}; make a body of them with: palpable reduce {} -o FILE\n",
             options.output, store.content().unit_count(), store.content().level_count(), fields,
             options.output);
  if (!stress.is_warning) print_text("{}\n", stress.text);
  if (aside) print_text("{}\n", set_aside_text(options.output, *aside));
}

}  // namespace

void add_import_snapshots(Command app) {
  const auto options = std::make_shared<ImportSnapshotsOptions>();
  Command command = app.add_subcommand(
      "import-snapshots", "Take over what another solver has computed (docs/snapshots.md)");
  command.add_option("folder", options->folder, "Folder with the files of the other solver")
      .required()
      .existing_folder()
      .type_name("DIR");
  command
      .add_option("--manifest", options->manifest,
                  "Text that says which file is which snapshot (docs/snapshots.md)")
      .required()
      .type_name("FILE.toml");
  command.add_option("-o,--out", options->output, "Folder of snapshots to write")
      .required()
      .type_name("DIR");
  command.add_json(options->json);
  command.footer("Example: palpable import-snapshots runs --manifest runs.toml -o bunny.snapshots");
  command.callback([options] { take_over_snapshots(*options); });
}

}  // namespace palpable::app

// palpable merge one.snapshots two.snapshots -o all.snapshots

#include "apps/common/command_line.h"
#include "apps/common/printing.h"
#include "apps/common/progress_bar.h"
#include "apps/palpable-bake/commands.h"
#include "palpable/bake/campaign/merge_stores.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/base/output_name.h"

#include <fmt/format.h>

#include <memory>
#include <string>
#include <vector>

namespace palpable::app {
namespace {

struct MergeOptions {
  std::vector<std::string> parts;
  std::string output;
  bool json = false;
};

void merge(const MergeOptions& options) {
  require_folder_name(options.output);
  guard_output_folder(options.output, {});  // the output may be one of the parts
  ProgressBar bar;
  const auto [merged, aside] =
      merge_stores({options.parts.begin(), options.parts.end()}, options.output, bar.progress());
  bar.finish();
  if (options.json) {
    print_json({{"folder", options.output},
                {"sites", merged.content().unit_count()},
                {"levels", merged.content().level_count()}});
    return;
  }
  print_text("{}: {} sites x {} levels; make a body of them with: palpable reduce {} -o FILE\n",
             options.output, merged.content().unit_count(), merged.content().level_count(),
             options.output);
  if (aside) print_text("{}\n", set_aside_text(options.output, *aside));
}

}  // namespace

void add_merge(Command app) {
  const auto options = std::make_shared<MergeOptions>();
  Command command =
      app.add_subcommand("merge", "Collect snapshots of one campaign that were solved apart");
  command.add_option("parts", options->parts, "Folders that palpable bake --shard filled")
      .required()
      .type_name("DIR");
  command.add_option("-o,--out", options->output, "Folder to collect them in; may be one of them")
      .required()
      .type_name("DIR");
  command.add_json(options->json);
  command.footer("Example: palpable merge a.snapshots b.snapshots -o bunny.snapshots");
  command.callback([options] { merge(*options); });
}

}  // namespace palpable::app

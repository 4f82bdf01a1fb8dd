// palpable reduce bunny.snapshots -o bunny.palpable

#include "apps/common/command_line.h"
#include "apps/common/printing.h"
#include "apps/common/progress_bar.h"
#include "apps/palpable-bake/body_report.h"
#include "apps/palpable-bake/commands.h"
#include "palpable/bake/pipeline/bake_body.h"
#include "palpable/bake/pipeline/bake_to_file.h"
#include "palpable/bake/pipeline/bake_touch.h"
#include "palpable/bake/separate/sparse_pgd.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/file_format.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/base/output_name.h"
#include "palpable/common/base/text_numbers.h"
#include "palpable/common/body_file/touch_file.h"
#include "palpable/common/body_file/touch_text.h"

#include <fmt/core.h>

#include <chrono>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace palpable::app {
namespace {

struct ReduceOptions {
  std::string store;
  std::string output;
  std::string method, norm;
  double tolerance = 0;
  int max_modes = 0;
  std::optional<double> part;
  std::uint64_t seed = 0;  // 0: not given
  std::vector<std::string> set;
  bool json = false;
  bool overwrite = false;
  FileOptions file;
};

// Selects a method for the whole tensor, or sparse PGD.
void set_method(const ReduceOptions& options, ReduceSettings& settings) {
  const bool sparse = options.method == kSparsePgdName;
  if (!sparse && (options.part || options.seed > 0)) {
    throw Error(fmt::format("{}: only --method {} learns from a part of the snapshots",
                            options.part ? "--part" : "--seed", kSparsePgdName));
  }
  if (sparse && (options.tolerance > 0.0 || !options.norm.empty())) {
    throw Error(
        fmt::format("{}: --method {} stops where further modes no longer help, and at "
                    "--max-modes at the latest",
                    options.norm.empty() ? "--tolerance" : "--norm", kSparsePgdName));
  }
  if (sparse) {
    settings.sparse.emplace();
    if (options.part) settings.sparse->part = *options.part;
    if (options.seed > 0) settings.sparse->seed = options.seed;
    return;
  }
  if (!options.method.empty()) settings.method = method_named(options.method);
}

void reduce(const ReduceOptions& options, const std::string& command_line) {
  guard_output_file(options.output, {options.store});
  require_ending(options.output, {kBodyFileEnding}, "a body file");
  guard_format(options.output, FileFormat::kBody);
  const auto begin = std::chrono::steady_clock::now();
  ReduceSettings settings{.at = parse_settings(options.set),
                          .volume = options.file.volume,
                          .version = std::string("palpable ") + PALPABLE_VERSION,
                          .command_line = command_line};
  set_method(options, settings);
  if (!options.norm.empty()) settings.own_norms = options.norm == "own";
  if (options.tolerance > 0.0) settings.tolerance = options.tolerance;
  if (options.max_modes > 0) settings.max_modes = options.max_modes;
  const SnapshotStore store = SnapshotStore::open(options.store);
  const BodyStage stage = kept_touch_stage(store);
  const std::optional<TouchTables> touch = kept_touch_tables(store);
  if (!options.overwrite) {
    expect_no_later_stage(options.output, stage);
    if (!touch) expect_no_lost_tables(options.output);
  }
  ProgressBar bar;
  BakedBody baked = reduce_store(store, settings, bar.progress());
  bar.finish();
  if (touch) {
    baked.body.provenance.touch = touch_line(*touch);
    baked.body.provenance.stage = stage;
    baked.body.error =
        write_touchable_body(options.output, baked.body, *touch, options.file.storage());
  } else {
    baked.body.error = write_body_file(options.output, baked.body, options.file.storage());
  }
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  if (options.json) {
    print_json(body_report(baked, options.output, taken.count()));
    return;
  }
  print_body_report(baked, options.output, taken.count());
  if (touch) print_text("touch: {}\n", touch_text(touch));
}

}  // namespace

void add_reduce(Command app, const std::string& command_line) {
  const auto options = std::make_shared<ReduceOptions>();
  std::vector<std::string> methods = method_names();
  methods.emplace_back(kSparsePgdName);
  Command command = app.add_subcommand("reduce", "Make a body file from snapshots");
  command
      .add_option("snapshots", options->store,
                  "Folder that palpable bake, merge or import-snapshots has written")
      .required()
      .type_name("DIR");
  command.add_option("-o,--out", options->output, "Body file to write")
      .type_name("FILE.palpable")
      .required();
  command
      .add_option(
          "--method", options->method,
          "How (docs/reduction.md); pgd is the paper's, sparse-pgd learns from a part of the "
          "snapshots")
      .one_of(methods)
      .default_is("as the description says");
  command
      .add_option("--tolerance", options->tolerance,
                  "Relative error for displacement and stress each: over all snapshots, or with "
                  "per-site over those of each site")
      .in_range(1e-6, 0.999)
      .default_is(
          "as the description says; with a --method other than its own 1e-3 (per-site: 1e-4)");
  command.add_option("--max-modes", options->max_modes, "Stop at this many modes at the latest")
      .in_range(1, 100000)
      .default_is("as the description says; sparse-pgd: 40");
  command
      .add_option(
          "--norm", options->norm,
          "own: each snapshot counts by its own norm, so that small presses are as accurate "
          "as large ones; pooled: by its size")
      .one_of({"own", "pooled"})
      .default_is("own with per-site, else pooled");
  command
      .add_option("--part", options->part,
                  "sparse-pgd: the part of the snapshots that is learnt from, drawn at random; the "
                  "file states the errors of the others too")
      .in_range(1e-6, 0.999999)
      .default_is("0.3");
  command.add_option("--seed", options->seed, "sparse-pgd: decides which those are")
      .in_range(std::uint64_t{1}, std::uint64_t{std::numeric_limits<std::int64_t>::max()})
      .default_is("1");
  add_value_option(command, options->set);
  add_file_options(command, options->file);
  add_overwrite(command, options->overwrite);
  command.add_json(options->json);
  command.footer(
      "Example: palpable reduce bunny.snapshots --method pgd --tolerance 1e-3 -o bunny.palpable");
  command.callback([options, command_line] { reduce(*options, command_line); });
}

}  // namespace palpable::app

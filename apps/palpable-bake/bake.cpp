// palpable bake BODY.toml -o bunny.palpable

#include "apps/common/command_line.h"
#include "apps/common/progress_bar.h"
#include "apps/palpable-bake/body_report.h"
#include "apps/palpable-bake/commands.h"
#include "apps/palpable-bake/description_argument.h"
#include "palpable/bake/campaign/crew.h"
#include "palpable/bake/campaign/fill_store.h"
#include "palpable/bake/campaign/solid_file.h"
#include "palpable/bake/campaign/store_rows.h"
#include "palpable/bake/intrusive/intrusive_bake.h"
#include "palpable/bake/pipeline/bake_body.h"
#include "palpable/bake/pipeline/bake_modal.h"
#include "palpable/bake/pipeline/bake_touch.h"
#include "palpable/bake/pipeline/held_out_checks.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/base/text_numbers.h"
#include "palpable/common/body_file/touch_file.h"
#include "palpable/common/body_file/touch_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace palpable::app {
namespace {

struct BakeOptions {
  std::string description;
  std::string output;
  std::string store;
  std::string shard;
  std::string solver = "own";
  std::string method;
  std::vector<std::string> at;
  int threads = 0;
  bool held_out = false;
  bool no_touch = false;
  std::string until;
  FileOptions file;
};

// Parses "2/4", the second of four shards.
void read_shard(const std::string& text, FillSettings& settings) {
  constexpr long long kMostShards = 100'000;  // the largest number of sites of a body
  const std::size_t slash = std::min(text.find('/'), text.size());
  const auto number = to_whole_number(std::string_view(text).substr(0, slash));
  const auto count = to_whole_number(std::string_view(text).substr(slash + (slash < text.size())));
  if (!number || !count || *number < 1 || *count < *number || *count > kMostShards) {
    throw Error(
        fmt::format("--shard {}: must be I/N, such as 1/4, 2/4, 3/4 and 4/4, with {} parts "
                    "at most",
                    text, kMostShards));
  }
  settings.shard = static_cast<int>(*number - 1);
  settings.shards = static_cast<int>(*count);
}

std::filesystem::path store_of(const BakeOptions& options) {
  if (!options.store.empty()) return options.store;
  return std::filesystem::path(options.output).replace_extension(".snapshots");
}

// Bakes a body by PGD, which needs no campaign.
void bake_without_campaign(const BakeOptions& options, const BodyDescription& description,
                           const std::string& command_line) {
  for (const auto& [option, given] : {std::pair{"--snapshots", !options.store.empty()},
                                      {"--shard", !options.shard.empty()},
                                      {"--held-out", options.held_out},
                                      {"--at", !options.at.empty()},
                                      {"--volume", options.file.volume},
                                      {"--until", !options.until.empty()},
                                      {"--solver", options.solver != "own"}}) {
    if (given)
      throw Error(
          fmt::format("{} is for a campaign, which --method intrusive-pgd does without", option));
  }
  if (!description.touch.by_default &&
      description.touch.tables != BodyDescription::Touch::Tables::kNone) {
    throw Error(
        fmt::format("{}: [touch] has tables made after a campaign, which --method "
                    "intrusive-pgd does without",
                    options.description));
  }
  ProgressBar bar;
  const IntrusiveBake made = bake_intrusive(
      description,
      {.version = std::string("palpable ") + PALPABLE_VERSION, .command_line = command_line},
      bar.progress());
  bar.finish();
  std::string touch = touch_text(std::nullopt);
  if (made.body.several && description.touch.by_default) {
    const ModalTables tables = modal_tables(made);
    write_touchable_body(options.output, made.body, tables, options.file.storage());
    touch = touch_text(tables, made.body);
  } else {
    write_body_file(options.output, made.body, options.file.storage());
  }
  fmt::print("touch: {}\n", touch);
  const std::filesystem::path solid = solid_file_of(options.output);
  write_solid_file(solid, content_of(description, made.travelling.problem));
  for (const auto& [key, value] : lines_of(made.report.provenance))
    fmt::print("{}: {}\n", key, value);
  std::string times;
  for (const StageTime& stage : made.report.cpu.stages()) {
    times += fmt::format("{}{} {:.1f} s", times.empty() ? "" : ", ", stage.name, 1e-3 * stage.ms);
  }
  const double references = made.report.cpu.ms("references");
  fmt::print("CPU: {}; without references {:.1f} s\n{} written: {:.1f} MB; its mesh and law: {}\n",
             times, 1e-3 * (made.report.cpu.total_ms() - references), options.output,
             1e-6 * static_cast<double>(std::filesystem::file_size(options.output)),
             solid.string());
}

void print_campaign(const FilledStore& filled) {
  const std::string folder = filled.store.folder().string();
  const StoreContent& content = filled.store.content();
  fmt::print(
      "snapshots: {}, {} sites solved, {} were there; look at them with ParaView: "
      "{}/campaign.xdmf\n",
      folder, filled.campaign.solved, filled.campaign.reused, folder);
  if (const auto& aside = filled.set_aside) { fmt::print("{}\n", set_aside_text(folder, *aside)); }
  if (content.linear.empty()) return;
  fmt::print("linear responses of {} vertices: {} of {} files made now\n", content.linear.size(),
             filled.campaign.linear_solved, content.linear_file_count());
}

void print_parameters(const StoreContent& content, const ReducedBody& body,
                      const std::string& store, const std::string& output) {
  if (content.parameters.empty()) return;
  const std::string& first = content.parameters[0].name;
  if (body.further.empty()) {
    fmt::print(
        "this body file holds one value of each parameter ({}); for another: palpable reduce "
        "{} --at {}=... -o FILE\n",
        body.material, store, first);
  } else {
    fmt::print("this body file holds all values of '{}': palpable view {} --set {}=...\n", first,
               output, first);
  }
}

// Shortens the description to the stages up to --until. Their results are kept with the snapshots,
// so that a later complete bake continues from there.
void shorten(const std::string& until, BodyDescription& description) {
  if (until.empty()) return;
  using Tables = BodyDescription::Touch::Tables;
  if (description.touch.tables == Tables::kNone) {
    throw Error("--until linear: this body has no tables of touch, so it is done without");
  }
  description.touch.tables = Tables::kLinear;
  description.touch.held_out = 0;
}

// Reduces a complete campaign, measures the errors, and writes the body.
BakedBody reduce_and_write(const BakeOptions& options, const ReduceSettings& reduction,
                           const BodyDescription& description, const FillSettings& settings,
                           const SnapshotStore& store, const Progress& progress) {
  BakedBody baked = reduce_store(store, reduction, progress);
  if (options.held_out) {
    check_between_levels(description, settings, store, point_of(store.content(), reduction.at),
                         baked, progress);
    check_between_values(description, settings, store, baked, progress);
  }
  baked.body.error = write_body_file(options.output, baked.body, options.file.storage());
  return baked;
}

// Makes the tables of the description and writes the body file again after each stage. Returns a
// summary of the tables, or why there are none.
std::string add_touch(const BakeOptions& options, const BodyDescription& description,
                      const FilledStore& filled, int threads, ReducedBody& body,
                      const Progress& progress) {
  std::string text = touch_text(std::nullopt);
  const std::string why = bake_touch(
      description, filled.plan, filled.store, threads,
      [&](const TouchTables& tables) {
        body.provenance.touch = touch_line(tables);
        body.error = write_touchable_body(options.output, body, tables, options.file.storage());
        text = touch_text(tables);
      },
      progress);
  return why.empty() ? text : text + ": " + why;
}

void bake(const BakeOptions& options, const std::string& command_line, Crew& crew) {
  const auto begin = std::chrono::steady_clock::now();
  BodyDescription description = read_description(options.description);
  if (options.no_touch) {
    description.touch = {.tables = BodyDescription::Touch::Tables::kNone, .by_default = false};
  }
  shorten(options.until, description);
  const std::vector<std::filesystem::path> inputs{options.description, description.shape.file};
  guard_output_file(options.output, inputs);
  const bool has_campaign = options.method != "intrusive-pgd";
  if (!has_campaign) guard_output_file(solid_file_of(options.output), inputs);
  if (crew.leads()) print_size(description);
  if (!has_campaign) {
    if (crew.leads()) bake_without_campaign(options, description, command_line);
    return;
  }
  FillSettings settings{
      .threads = options.threads,
      .store = store_of(options),
      .solver = options.solver == "calculix" ? FeSolver::kCalculix : FeSolver::kOwn};
  guard_output_folder(settings.store, inputs);
  refuse_among_snapshots(options.output, settings.store);
  if (!options.shard.empty()) read_shard(options.shard, settings);
  const ReduceSettings reduction{.at = parse_values(options.at),
                                 .volume = options.file.volume,
                                 .version = std::string("palpable ") + PALPABLE_VERSION,
                                 .command_line = command_line};
  ProgressBar bar;
  const Progress progress = crew.leads() ? bar.progress() : Progress{};
  const FilledStore filled = fill_store(description, settings, crew, progress);
  if (!crew.leads()) return;
  const std::string folder = filled.store.folder().string();
  if (settings.shards > 1) {
    bar.finish();
    fmt::print(
        "{}: {} sites solved here, {} were there; when all shards are done: "
        "palpable merge {} and the like -o NAME.snapshots\n",
        folder, filled.campaign.solved, filled.campaign.reused, folder);
    return;
  }
  BakedBody baked =
      reduce_and_write(options, reduction, description, settings, filled.store, progress);
  const std::string touch =
      add_touch(options, description, filled, crew.threads(options.threads), baked.body, progress);
  bar.finish();
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  print_body_report(baked, options.output, taken.count());
  fmt::print("touch: {}\n", touch);
  print_campaign(filled);
  if (!options.until.empty()) {
    fmt::print("stopped after the linear tables: the same command without --until goes on\n");
  }
  print_parameters(filled.store.content(), baked.body, folder, options.output);
}

}  // namespace

void add_bake(Command app, const std::string& command_line, Crew& crew) {
  const auto options = std::make_shared<BakeOptions>();
  Command command =
      app.add_subcommand("bake", "Mesh, solve and reduce: a body file from a description");
  command.add_option("body", options->description, "What to bake (docs/body.md)")
      .required()
      .type_name("BODY.toml");
  command.add_option("-o,--out", options->output, "Body file to write")
      .required()
      .type_name("FILE");
  command
      .add_option("--snapshots", options->store,
                  "Folder for the snapshots; those that are there and valid are not solved again. "
                  "Default: NAME.snapshots beside the body file")
      .type_name("FOLDER");
  command
      .add_option("--method", options->method,
                  "No campaign: the load of [intrusive] travels over a face and the "
                  "PGD solves for all its positions and sizes (docs/reduction.md)")
      .one_of({"intrusive-pgd"});
  command.add_option("--threads", options->threads, "Sites solved side by side; 0: one per core")
      .in_range(0, 4096)
      .show_default();
  command
      .add_option("--shard", options->shard,
                  "Solve only this part of the sites and stop there (docs/scaling.md)")
      .type_name("I/N");
  command.add_flag("--held-out", options->held_out,
                   "Also solve the levels in between (and the values of a free parameter in "
                   "between), and say how far the body is from them; takes as long as the campaign "
                   "again; snapshots go to NAME.held-out and NAME.between-PARAMETER");
  command.add_flag("--no-touch", options->no_touch,
                   "Leave out the tables of touch, whatever the description says: the body is "
                   "touched at its sites, and done much sooner (the paper's bunny in a minute, "
                   "not twenty)");
  command
      .add_option("--until", options->until,
                  "linear: stop as soon as the body can be touched anywhere with small loads; the "
                  "same command without it goes on from there. Default: the whole body")
      .one_of({"linear"});
  command.add_option("--solver", options->solver, "own: this project's; calculix: runs ccx")
      .one_of({"own", "calculix"})
      .show_default();
  command
      .add_option("--at", options->at,
                  "The one value of a further parameter that the body file holds. Default: the "
                  "parameter stays free")
      .type_name("NAME=VALUE");
  add_file_options(command, options->file);
  command.footer(
      "A bake that was stopped goes on where it was when the same command is run again.\n"
      "On several cores or machines: mpirun -n 4 palpable bake ...\n"
      "Example: palpable bake bodies/bunny-demo.toml -o bunny.palpable");
  command.callback([options, command_line, &crew] { bake(*options, command_line, crew); });
}

}  // namespace palpable::app

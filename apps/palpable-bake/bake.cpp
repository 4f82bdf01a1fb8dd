// palpable bake BODY.toml -o bunny.palpable

#include "apps/common/command_line.h"
#include "apps/common/interruption.h"
#include "apps/common/printing.h"
#include "apps/common/progress_bar.h"
#include "apps/palpable-bake/body_report.h"
#include "apps/palpable-bake/commands.h"
#include "apps/palpable-bake/description_argument.h"
#include "palpable/bake/campaign/crew.h"
#include "palpable/bake/campaign/solid_file.h"
#include "palpable/bake/describe/material_warnings.h"
#include "palpable/bake/pipeline/bake_counts.h"
#include "palpable/bake/pipeline/bake_estimate.h"
#include "palpable/bake/pipeline/bake_to_file.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/file_format.h"
#include "palpable/common/base/folder_lock.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/base/output_name.h"
#include "palpable/common/base/text_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace palpable::app {
namespace {

using Clock = std::chrono::steady_clock;

struct BakeOptions {
  std::string description;
  std::string output;
  std::string store;
  std::string shard;
  std::string solver = "own";
  bool intrusive = false;
  std::vector<std::string> set;
  int threads = 0;
  bool held_out = false;
  bool no_touch = false;
  bool overwrite = false;
  std::string until;
  FileOptions file;
  bool estimate = false;
  bool json = false;
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

// Refuses options of a campaign where there is none.
void refuse_campaign_options(const BakeOptions& options) {
  for (const auto& [option, given] : {std::pair{"--snapshots", !options.store.empty()},
                                      {"--shard", !options.shard.empty()},
                                      {"--held-out", options.held_out},
                                      {"--set", !options.set.empty()},
                                      {"--volume", options.file.volume},
                                      {"--until", !options.until.empty()},
                                      {"--solver", options.solver != "own"}}) {
    if (given)
      throw Error(fmt::format("{} is for a campaign, which --intrusive does without", option));
  }
}

void print_intrusive(const IntrusiveReport& report, const std::string& touch,
                     const std::string& output) {
  print_text("touch: {}\n", touch);
  for (const auto& [key, text] : lines_of(report.provenance)) fmt::print("{}: {}\n", key, text);
  std::string times;
  for (const StageTime& stage : report.cpu.stages()) {
    times += fmt::format("{}{} {:.1f} s", times.empty() ? "" : ", ", stage.name, 1e-3 * stage.ms);
  }
  const double references = report.cpu.ms("references");
  print_text("CPU: {}; without references {:.1f} s\n{} written: {:.1f} MB; its mesh and law: {}\n",
             times, 1e-3 * (report.cpu.total_ms() - references), output,
             1e-6 * static_cast<double>(std::filesystem::file_size(output)),
             solid_file_of(output).string());
}

void print_shard(const FilledStore& filled) {
  const std::string folder = filled.store.folder().string();
  print_text(
      "{}: {} sites solved here, {} were there; when all shards are done: "
      "palpable merge {} and the like -o NAME.snapshots\n",
      folder, filled.campaign.solved, filled.campaign.reused, folder);
}

void print_campaign(const FilledStore& filled) {
  const std::string folder = filled.store.folder().string();
  const StoreContent& content = filled.store.content();
  print_text(
      "snapshots: {}, {} sites solved, {} were there; look at them with ParaView: "
      "{}/campaign.xdmf\n",
      folder, filled.campaign.solved, filled.campaign.reused, folder);
  if (const auto& aside = filled.set_aside) { fmt::print("{}\n", set_aside_text(folder, *aside)); }
  if (content.linear.empty()) return;
  print_text("linear responses of {} vertices: {} of {} files made now\n", content.linear.size(),
             filled.campaign.linear_solved, content.linear_file_count());
}

void print_parameters(const SnapshotStore& store, const ReducedBody& body,
                      const std::string& output) {
  if (store.content().parameters.empty()) return;
  const std::string& first = store.content().parameters[0].name;
  if (body.further.empty()) {
    print_text(
        "this body file holds one value of each parameter ({}); for another: palpable reduce "
        "{} --set {}=... -o FILE\n",
        body.material, store.folder().string(), first);
  } else {
    print_text("this body file holds all values of '{}': palpable view {} --set {}=...\n", first,
               output, first);
  }
}

// Shortens the description to the stages up to --until. Their results are kept with the snapshots,
// so that a later complete bake continues from there. @return the stage of the body file then
BodyStage shorten(const std::string& until, BodyDescription& description) {
  if (until.empty()) return BodyStage::kFinished;
  using Tables = BodyDescription::Touch::Tables;
  if (description.touch.tables == Tables::kNone) {
    throw Error("--until linear: this body has no tables of touch, so it is done without");
  }
  const bool is_whole =
      description.touch.tables == Tables::kLinear && description.touch.held_out == 0;
  description.touch.tables = Tables::kLinear;
  description.touch.held_out = 0;
  return is_whole ? BodyStage::kFinished : BodyStage::kLinear;
}

// What a campaign is made with. Reads and checks the options that only a campaign has.
FillSettings campaign_settings(const BakeOptions& options,
                               const std::vector<std::filesystem::path>& inputs) {
  FillSettings settings{
      .threads = options.threads,
      .store = store_of(options),
      .solver = options.solver == "calculix" ? FeSolver::kCalculix : FeSolver::kOwn};
  require_folder_name(settings.store);
  guard_output_folder(settings.store, inputs);
  refuse_among_snapshots(options.output, settings.store);
  if (!options.shard.empty()) read_shard(options.shard, settings);
  return settings;
}

Json baked_json(const BakedFile& baked, const BakeOptions& options, Clock::time_point begin) {
  const std::chrono::duration<double> taken = Clock::now() - begin;
  Json result;
  if (baked.body) {
    result = body_report(*baked.body, options.output, taken.count());
  } else {
    result = {{"file", options.output}, {"seconds", taken.count()}};
  }
  if (baked.campaign) {
    result["snapshots"] = baked.campaign->store.folder().string();
    result["sites_solved"] = baked.campaign->campaign.solved;
    result["sites_reused"] = baked.campaign->campaign.reused;
  }
  if (!baked.touch.empty()) result["touch"] = baked.touch;
  return result;
}

struct WantedBody {
  BodyDescription description;
  BodyStage last_stage = BodyStage::kFinished;
};

// The description with what options leave out of it.
WantedBody wanted_body(const BakeOptions& options) {
  WantedBody wanted{read_description(options.description)};
  if (options.no_touch) {
    wanted.description.touch = {.tables = BodyDescription::Touch::Tables::kNone,
                                .by_default = false};
  }
  wanted.last_stage = shorten(options.until, wanted.description);
  return wanted;
}

BakeToFileSettings settings_of(const BakeOptions& options, const std::string& command_line) {
  BakeToFileSettings settings{.output = options.output,
                              .storage = options.file.storage(),
                              .with_campaign = !options.intrusive,
                              .reduction = {.volume = options.file.volume,
                                            .version = std::string("palpable ") + PALPABLE_VERSION,
                                            .command_line = command_line},
                              .held_out = options.held_out};
  if (settings.with_campaign) settings.reduction.at = parse_settings(options.set);
  return settings;
}

// --estimate: says what the bake would take, and writes nothing.
void estimate(const BakeOptions& options, Crew& crew) {
  if (!crew.leads()) return;
  if (options.intrusive) refuse_campaign_options(options);
  if (options.solver != "own") {
    throw Error("--estimate knows this project's own solver only, not --solver calculix");
  }
  const BodyDescription description = wanted_body(options).description;
  print_size(description);
  BakeToFileSettings settings = settings_of(options, {});
  expect_values(description, settings.reduction.at);
  if (!options.shard.empty()) read_shard(options.shard, settings.fill);
  ProgressBar bar;
  const CountedBake counted = count_bake(description, settings, bar.progress());
  bar.finish();
  const BakeEstimate result =
      estimate_of(counted.counts, counted.costs, crew.threads(options.threads));
  if (options.json) {
    print_json(json_of(result));
  } else {
    print_text(text_of(result));
  }
}

// What full loads came to, and where they hardly move the body, with the stiffness in words.
void print_full_load(const BakedFile& baked, const BodyDescription& description) {
  print_text("{}\n", full_press_text(description, baked.press));
  if (const auto text = hardly_moves_text(description, baked.movement)) print_text("{}\n", *text);
}

// A warning, which is on stderr also with --json.
void warn_of_absurd_press(const BakedFile& baked, const BodyDescription& description) {
  if (!baked.body) return;
  if (const auto text = absurd_press_text(description, baked.press)) {
    fmt::print(stderr, "warning: {}: {}\n", description.source.string(), *text);
  }
}

void print_baked(const BakedFile& baked, const BodyDescription& description,
                 const BakeOptions& options, Clock::time_point begin) {
  if (options.json) {
    print_json(baked_json(baked, options, begin));
  } else if (baked.body) {
    const std::chrono::duration<double> taken = Clock::now() - begin;
    print_body_report(*baked.body, options.output, taken.count());
    print_text("touch: {}\n", baked.touch);
    print_campaign(*baked.campaign);
    if (!options.until.empty()) {
      print_text("stopped after the linear tables: the same command without --until goes on\n");
    }
    print_parameters(baked.campaign->store, baked.body->body, options.output);
    print_full_load(baked, description);
  } else if (baked.campaign) {
    print_shard(*baked.campaign);
  } else {
    print_intrusive(*baked.intrusive, baked.touch, options.output);
    print_full_load(baked, description);
  }
}

// What is printed when the user ends the bake.
// @param there  the stage of the body file before it
std::string text_at_interruption(const BakeOptions& options, const BakeToFileSettings& settings,
                                 std::optional<BodyStage> there, const std::string& command_line) {
  const std::string file =
      there == BodyStage::kFinished ? fmt::format(", and {} is as it was", options.output) : "";
  if (!settings.with_campaign) {
    return fmt::format("stopped{}; a bake without a campaign begins anew: {}", file, command_line);
  }
  return fmt::format("stopped; what is done is kept in {}{}; this goes on with it: {}",
                     settings.fill.store.string(), file, command_line);
}

void bake(const BakeOptions& options, const std::string& command_line, Crew& crew) {
  const auto begin = Clock::now();
  if (options.output.empty())
    throw Error(
        "--out is required, or --estimate for what the bake would take, see palpable bake --help");
  const auto [description, last_stage] = wanted_body(options);
  const std::vector<std::filesystem::path> inputs{options.description, description.shape.file};
  guard_output_file(options.output, inputs);
  if (options.intrusive) guard_output_file(solid_file_of(options.output), inputs);
  if (crew.leads()) print_size(description);
  BakeToFileSettings settings = settings_of(options, command_line);
  if (settings.with_campaign) {
    expect_values(description, settings.reduction.at);
    settings.fill = campaign_settings(options, inputs);
  } else if (crew.leads()) {
    refuse_campaign_options(options);
  }
  require_ending(options.output, {kBodyFileEnding}, "a body file");
  guard_format(options.output, FileFormat::kBody);
  settings.last_stage = last_stage;
  settings.overwrite = options.overwrite;
  const bool writes = settings.fill.shards == 1;
  std::optional<OutputLock> lock;
  if (crew.leads() && writes) lock.emplace(options.output);
  if (writes && !options.overwrite) {
    expect_no_later_stage(options.output, last_stage);
    if (!makes_tables(description, settings.with_campaign))
      expect_no_lost_tables(options.output, description.name);
  }
  const std::optional<BodyStage> there =
      crew.leads() && writes ? stage_of_file(options.output) : std::nullopt;
  if (there == BodyStage::kFinished) {
    print_note("{}: stays as it is until this bake is finished", options.output);
  }
  const InterruptionNote note(
      crew.leads() ? text_at_interruption(options, settings, there, command_line) : "",
      lock ? lock_beside(options.output).string() : "");
  ProgressBar bar;
  const std::optional<BakedFile> baked =
      bake_to_file(description, settings, crew, crew.leads() ? bar.progress() : Progress{});
  if (!baked) return;
  bar.finish();
  print_baked(*baked, description, options, begin);
  warn_of_absurd_press(*baked, description);
}

}  // namespace

void add_bake(Command app, const std::string& command_line, Crew& crew) {
  const auto options = std::make_shared<BakeOptions>();
  Command command =
      app.add_subcommand("bake", "Mesh, solve and reduce: a body file from a description");
  add_description(command, options->description);
  command.add_option("-o,--out", options->output, "Body file to write")
      .type_name("FILE.palpable")
      .default_is("none; required without --estimate");
  command.add_flag(
      "--estimate", options->estimate,
      "Only print how long the whole bake will take here, how much memory it needs and "
      "how large its file will be, each within a factor of two; writes nothing, and "
      "takes some seconds, since the body is meshed");
  command
      .add_option("--snapshots", options->store,
                  "Folder for the snapshots; those that are there and valid are not solved again")
      .type_name("DIR")
      .default_is("NAME.snapshots beside the body file");
  command.add_flag("--intrusive", options->intrusive,
                   "No campaign: the load of [intrusive] travels over a face, and the PGD solves "
                   "for all its positions and sizes (docs/reduction.md)");
  add_threads(command, options->threads, "Sites solved side by side");
  command
      .add_option("--shard", options->shard,
                  "Solve only this part of the sites and stop there (docs/scaling.md)")
      .type_name("I/N")
      .default_is("all");
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
                  "same command without it goes on from there")
      .one_of({"linear"})
      .default_is("the whole body");
  command.add_option("--solver", options->solver, "own: this project's; calculix: runs ccx")
      .one_of({"own", "calculix"})
      .show_default();
  add_value_option(command, options->set);
  add_file_options(command, options->file);
  add_overwrite(command, options->overwrite);
  command.add_json(options->json);
  command.footer(
      "A bake that was stopped goes on where it was when the same command is run again.\n"
      "On several cores or machines: mpirun -n 4 palpable bake ...\n"
      "Example: palpable bake bodies/bunny-demo.toml -o bunny.palpable");
  command.callback([options, command_line, &crew] {
    if (options->estimate) {
      estimate(*options, crew);
    } else {
      bake(*options, command_line, crew);
    }
  });
}

}  // namespace palpable::app

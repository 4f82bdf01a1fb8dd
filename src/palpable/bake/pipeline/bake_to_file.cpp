#include "palpable/bake/pipeline/bake_to_file.h"

#include "palpable/bake/campaign/solid_file.h"
#include "palpable/bake/campaign/store_rows.h"
#include "palpable/bake/pipeline/bake_modal.h"
#include "palpable/bake/pipeline/bake_touch.h"
#include "palpable/bake/pipeline/held_out_checks.h"
#include "palpable/common/base/error.h"
#include "palpable/common/body_file/touch_file.h"
#include "palpable/common/body_file/touch_text.h"
#include "palpable/common/geometry/size_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <utility>

namespace palpable {
namespace {

// Fills in what the body does at full load, at the site that moves or bears most.
void add_full_load(const ReducedBody& body, BakedFile& baked) {
  baked.movement = {body.press_depth.maxCoeff(), extent_of(body.surface.vertices).maxCoeff(), 0.0};
  for (const Site& site : body.sites) {
    baked.movement.force = std::max(baked.movement.force, site.full_load);
  }
  baked.press = {baked.movement.force, body.largest_von_mises};
}

BakedFile bake_without_campaign(const BodyDescription& description,
                                const BakeToFileSettings& settings, const Progress& progress) {
  if (!description.touch.by_default &&
      description.touch.tables != BodyDescription::Touch::Tables::kNone) {
    throw Error(
        fmt::format("{}: [touch] has tables made after a campaign, which "
                    "--intrusive does without",
                    description.source.string()));
  }
  IntrusiveBake made = bake_intrusive(
      description,
      {.version = settings.reduction.version, .command_line = settings.reduction.command_line},
      progress);
  std::string touch = touch_text(std::nullopt);
  if (made.body.several && description.touch.by_default) {
    ModalTables tables = modal_tables(made);
    tables.friction = description.touch.friction;
    write_touchable_body(settings.output, made.body, tables, settings.storage);
    touch = touch_text(tables, made.body);
  } else {
    write_body_file(settings.output, made.body, settings.storage);
  }
  write_solid_file(solid_file_of(settings.output),
                   content_of(description, made.travelling.problem));
  BakedFile baked{.intrusive = std::move(made.report), .touch = std::move(touch)};
  add_full_load(made.body, baked);
  return baked;
}

// Writes the body at a stage, unless the file that is there is of a later one. It is looked at
// again each time, because another bake may have finished it meanwhile.
// @param write  writes it, and returns its errors
void publish(const BakeToFileSettings& settings, BodyStage stage, ReducedBody& body,
             const std::function<ReductionError()>& write) {
  const bool is_last = stage == BodyStage::kFinished;
  if (is_last) stage = settings.last_stage;
  const bool replaces = stage == BodyStage::kFinished || (is_last && settings.overwrite);
  if (!replaces && stage_of_file(settings.output) > stage) return;
  body.provenance.stage = stage;
  body.error = write();
}

void publish(const BakeToFileSettings& settings, BodyStage stage, ReducedBody& body) {
  publish(settings, stage, body,
          [&] { return write_body_file(settings.output, body, settings.storage); });
}

// Reduces a complete campaign, measures the errors, and writes the body.
BakedBody reduce_and_write(const BodyDescription& description, const BakeToFileSettings& settings,
                           const SnapshotStore& store, const Progress& progress) {
  BakedBody baked = reduce_store(store, settings.reduction, progress);
  if (settings.held_out) {
    check_between_levels(description, settings.fill, store,
                         point_of(store.content(), settings.reduction.at), baked, progress);
    check_between_values(description, settings.fill, store, baked, progress);
  }
  publish(settings, makes_tables(description, true) ? BodyStage::kReduced : BodyStage::kFinished,
          baked.body);
  return baked;
}

// Makes the tables of the description and writes the body file again after each stage. Returns a
// summary of the tables, or why there are none.
std::string add_touch(const BodyDescription& description, const BakeToFileSettings& settings,
                      const FilledStore& filled, int threads, ReducedBody& body,
                      const Progress& progress) {
  std::string text = touch_text(std::nullopt);
  const std::string why = bake_touch(
      description, filled.plan, filled.store, threads,
      [&](const TouchTables& tables, BodyStage stage) {
        body.provenance.touch = touch_line(tables);
        publish(settings, stage, body, [&] {
          return write_touchable_body(settings.output, body, tables, settings.storage);
        });
        text = touch_text(tables);
      },
      progress);
  if (why.empty()) return text;
  publish(settings, BodyStage::kFinished, body);  // there will be no tables
  return text + ": " + why;
}

}  // namespace

void expect_values(const BodyDescription& description, const std::map<std::string, double>& at) {
  StoreContent content;
  content.parameters = stored_parameters(description);
  try {
    static_cast<void>(point_of(content, at));
  } catch (const Error& error) {
    throw Error(fmt::format("--set: {}: {}", description.source.string(), error.what()));
  }
}

std::optional<BodyStage> stage_of_file(const std::filesystem::path& file) {
  const Result<ReducedBody> body = read_body_file(file);
  if (!body.ok()) return std::nullopt;
  return body.value().provenance.stage;
}

void expect_no_later_stage(const std::filesystem::path& file, BodyStage last) {
  const std::optional<BodyStage> there = stage_of_file(file);
  if (!(there > last)) return;
  throw Error(
      fmt::format("{}: holds a body that is baked further than this bake would go ({}), and would "
                  "be replaced by it; bake the whole body, or name another file",
                  file.string(), missing_at(last)));
}

void expect_no_lost_tables(const std::filesystem::path& file, const std::string& mine) {
  const Result<ReducedBody> there = read_body_file(file);
  if (!there.ok()) return;
  const ReducedBody& body = there.value();
  if (body.provenance.stage != BodyStage::kFinished) return;
  if (body.provenance.touch.empty() && !body.several) return;
  if (!mine.empty() && body.name == mine) return;
  throw Error(fmt::format(
      "{}: holds the finished body '{}' with {}, and would be replaced by one without; name "
      "another file, or give --overwrite",
      file.string(), body.name, body.several ? "modes for touches" : "tables of touch"));
}

bool makes_tables(const BodyDescription& description, bool with_campaign) {
  return !with_campaign || description.touch.tables != BodyDescription::Touch::Tables::kNone;
}

std::optional<BakedFile> bake_to_file(const BodyDescription& description,
                                      const BakeToFileSettings& settings, Crew& crew,
                                      const Progress& progress) {
  if (!settings.with_campaign) {
    if (!crew.leads()) return {};
    return bake_without_campaign(description, settings, progress);
  }
  BakedFile baked{.campaign = fill_store(description, settings.fill, crew, progress)};
  if (!crew.leads()) return {};
  if (settings.fill.shards > 1) return baked;
  const FilledStore& filled = *baked.campaign;
  baked.body = reduce_and_write(description, settings, filled.store, progress);
  add_full_load(baked.body->body, baked);
  baked.touch = add_touch(description, settings, filled, crew.threads(settings.fill.threads),
                          baked.body->body, progress);
  return baked;
}

}  // namespace palpable

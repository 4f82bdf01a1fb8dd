#include "palpable/bake/pipeline/bake_to_file.h"

#include "palpable/bake/campaign/solid_file.h"
#include "palpable/bake/campaign/store_rows.h"
#include "palpable/bake/pipeline/bake_modal.h"
#include "palpable/bake/pipeline/bake_touch.h"
#include "palpable/bake/pipeline/held_out_checks.h"
#include "palpable/common/base/error.h"
#include "palpable/common/body_file/touch_file.h"
#include "palpable/common/body_file/touch_text.h"

#include <fmt/format.h>

#include <utility>

namespace palpable {
namespace {

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
    const ModalTables tables = modal_tables(made);
    write_touchable_body(settings.output, made.body, tables, settings.storage);
    touch = touch_text(tables, made.body);
  } else {
    write_body_file(settings.output, made.body, settings.storage);
  }
  write_solid_file(solid_file_of(settings.output),
                   content_of(description, made.travelling.problem));
  return {.intrusive = std::move(made.report), .touch = std::move(touch)};
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
  baked.body.error = write_body_file(settings.output, baked.body, settings.storage);
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
      [&](const TouchTables& tables) {
        body.provenance.touch = touch_line(tables);
        body.error = write_touchable_body(settings.output, body, tables, settings.storage);
        text = touch_text(tables);
      },
      progress);
  return why.empty() ? text : text + ": " + why;
}

}  // namespace

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
  baked.touch = add_touch(description, settings, filled, crew.threads(settings.fill.threads),
                          baked.body->body, progress);
  return baked;
}

}  // namespace palpable

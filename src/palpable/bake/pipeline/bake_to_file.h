/// @file
/// `palpable bake`: from a description to a body file. With a campaign: the snapshots, their
/// reduction, the tables of touch; without one: intrusive PGD (intrusive_bake.h).
#pragma once

#include "palpable/bake/campaign/crew.h"
#include "palpable/bake/campaign/fill_store.h"
#include "palpable/bake/describe/body_description.h"
#include "palpable/bake/intrusive/intrusive_bake.h"
#include "palpable/bake/pipeline/bake_body.h"
#include "palpable/common/base/progress.h"
#include "palpable/common/body_file/body_file.h"

#include <filesystem>
#include <optional>
#include <string>

namespace palpable {

struct BakeToFileSettings {
  std::filesystem::path output;                 ///< the body file
  ModeStorage storage = ModeStorage::kFloat32;  ///< of its modes
  bool with_campaign = true;                    ///< false: intrusive PGD
  FillSettings fill = {};                       ///< of the campaign
  /// Of the campaign's snapshots. Its version and command line enter the provenance without a
  /// campaign, too.
  ReduceSettings reduction = {};
  /// Whether to compare the body with states between its levels and values (held_out_checks.h).
  bool held_out = false;
};

struct BakedFile {
  std::optional<FilledStore> campaign = {};       ///< none: made without one
  std::optional<BakedBody> body = {};             ///< none: no campaign, or only a shard of one
  std::optional<IntrusiveReport> intrusive = {};  ///< of a body without a campaign
  std::string touch = {};                         ///< its tables of touch, for people
};

/// Bakes a body into a file. With a campaign the file is written after its reduction, and again
/// after each stage of the tables of touch. Without one NAME.solid.h5 is written beside it
/// (solid_file.h). A shard of a campaign is solved only.
/// @returns nothing to those of the crew that do not lead it
/// @throws Error as fill_store(), reduce_store() and bake_touch(), or as bake_intrusive(); if the
///         description asks for tables of touch that a bake without a campaign does not make; when
///         a file cannot be written
[[nodiscard]] std::optional<BakedFile> bake_to_file(const BodyDescription& description,
                                                    const BakeToFileSettings& settings, Crew& crew,
                                                    const Progress& progress = {});

}  // namespace palpable

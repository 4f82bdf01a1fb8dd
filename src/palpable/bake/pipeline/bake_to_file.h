/// @file
/// `palpable bake`: from a description to a body file. With a campaign: the snapshots, their
/// reduction, the tables of touch; without one: intrusive PGD (intrusive_bake.h).
#pragma once

#include "palpable/bake/campaign/crew.h"
#include "palpable/bake/campaign/fill_store.h"
#include "palpable/bake/describe/body_description.h"
#include "palpable/bake/describe/material_warnings.h"
#include "palpable/bake/intrusive/intrusive_bake.h"
#include "palpable/bake/pipeline/bake_body.h"
#include "palpable/common/base/progress.h"
#include "palpable/common/body_file/body_file.h"

#include <filesystem>
#include <map>
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
  /// Of the file in the end: an earlier stage where the description was shortened to it.
  BodyStage last_stage = BodyStage::kFinished;
  /// Whether a body that is there is replaced in the end even if it is of a later stage.
  bool overwrite = false;
  /// Whether to compare the body with states between its levels and values (held_out_checks.h).
  bool held_out = false;
};

struct BakedFile {
  std::optional<FilledStore> campaign = {};       ///< none: made without one
  std::optional<BakedBody> body = {};             ///< none: no campaign, or only a shard of one
  std::optional<IntrusiveReport> intrusive = {};  ///< of a body without a campaign
  std::string touch = {};                         ///< its tables of touch, for people
  Movement movement = {};  ///< at full load, of the site that moves most; of a shard: zeros
  FullPress press = {};    ///< likewise
};

/// To be called before the work. @throws Error when `at` (ReduceSettings::at) names a parameter or
/// a value that the description does not have
void expect_values(const BodyDescription& description, const std::map<std::string, double>& at);

/// The stage of a body file; nothing where there is none that can be read.
[[nodiscard]] std::optional<BodyStage> stage_of_file(const std::filesystem::path& file);

/// To be called before the work. @throws Error when the file that is there is of a later stage than
/// `last`: a bake that was shortened would replace a better body
void expect_no_later_stage(const std::filesystem::path& file, BodyStage last);

/// To be called before the work whose body will have no tables of touch.
/// @param mine  name of the body that may lose them, because its description asks for none now;
///              empty: none may
/// @throws Error when the file that is there is a finished body with tables of touch, or with modes
///         for touches: what would be lost, and how it is replaced all the same (--overwrite)
void expect_no_lost_tables(const std::filesystem::path& file, const std::string& mine = {});

/// Whether the body of this description will have tables of touch, or, without a campaign, modes
/// for touches.
[[nodiscard]] bool makes_tables(const BodyDescription& description, bool with_campaign);

/// Bakes a body into a file. With a campaign the file is written after its reduction, and again
/// after each stage of the tables of touch, but only over a file that is not of a later stage: a
/// finished body stays, whole, until this one is finished. Without a campaign NAME.solid.h5 is
/// written beside the body (solid_file.h). A shard of a campaign is solved only.
/// @returns nothing to those of the crew that do not lead it
/// @throws Error as fill_store(), reduce_store() and bake_touch(), or as bake_intrusive(); if the
///         description asks for tables of touch that a bake without a campaign does not make; when
///         a file cannot be written
[[nodiscard]] std::optional<BakedFile> bake_to_file(const BodyDescription& description,
                                                    const BakeToFileSettings& settings, Crew& crew,
                                                    const Progress& progress = {});

}  // namespace palpable

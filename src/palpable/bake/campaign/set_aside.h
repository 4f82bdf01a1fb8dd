/// @file
/// Keeps the snapshots of a description that was edited since: they took hours, so they are moved
/// aside instead of being overwritten.
#pragma once

#include "palpable/bake/campaign/snapshot_store.h"

#include <filesystem>
#include <optional>
#include <string>

namespace palpable {

/// What happened to the snapshots that were in the folder.
struct SetAside {
  std::filesystem::path folder;  ///< where they are now: NAME.snapshots.1a2b3c4d
  int units = 0;                 ///< number of units in it
  int still_valid = 0;           ///< units that are valid for the new campaign as well; in both
  bool brought_back = false;     ///< the new campaign's own snapshots had been set aside earlier
};

/// The same as a sentence for the user. @param folder  of the store
[[nodiscard]] std::string set_aside_text(const std::filesystem::path& folder,
                                         const SetAside& aside);

/// A store that was filled from files, and what was set aside for it.
struct CollectedStore {
  SnapshotStore store;
  std::optional<SetAside> set_aside = {};
};

/// Makes room for the campaign `content`. Where `folder` holds units of another campaign, it is
/// renamed after the hash of that campaign. If snapshots of `content` were set aside earlier, their
/// folder is renamed back; otherwise a new folder is created. Units and linear responses that are
/// valid for both campaigns, and all tables of touch, are then linked into it.
/// @returns nothing where no folder had to be renamed
/// @throws Error when a folder cannot be renamed or a file cannot be linked, or while a run of
///         another campaign holds the lock of the folder
std::optional<SetAside> set_aside_other_campaign(const std::filesystem::path& folder,
                                                 const StoreContent& content);

/// Refuses a body file among the snapshots, where it could replace one of them.
/// @throws Error when `body` lies in the folder of the snapshots, or has its name
void refuse_among_snapshots(const std::filesystem::path& body, const std::filesystem::path& folder);

/// Refuses a folder of snapshots as the place of other files.
/// @throws Error when the folder holds a campaign
void refuse_campaign_folder(const std::filesystem::path& folder);

/// To be called by a run once it holds the lock of the folder: before that, a run of another
/// description may have taken the folder over.
/// @throws Error when the folder holds a campaign other than `content`
void require_own_campaign(const std::filesystem::path& folder, const StoreContent& content);

}  // namespace palpable

/// @file
/// Snapshots of a description that was edited: they took hours, and nobody asked for their end.
#pragma once

#include "palpable/bake/campaign/snapshot_store.h"

#include <filesystem>
#include <optional>
#include <string>

namespace palpable {

/// What happened to the snapshots that were there.
struct SetAside {
  std::filesystem::path folder;  ///< where they are now: NAME.snapshots.1a2b3c4d
  int units = 0;                 ///< sites (at one point each) in it
  int still_valid = 0;           ///< of them that hold for the new campaign, too, and stand in both
  bool brought_back = false;     ///< the new campaign's own snapshots had been set aside earlier
};

/// It in a sentence, for people. @param folder  the store that made room
[[nodiscard]] std::string set_aside_text(const std::filesystem::path& folder,
                                         const SetAside& aside);

/// A store that was filled from elsewhere, and what made room for it.
struct CollectedStore {
  SnapshotStore store;
  std::optional<SetAside> set_aside = {};
};

/// Makes room for a campaign: where `folder` holds units that are none of its own, the folder is
/// renamed by the hash of the campaign that they belong to. What was set aside for this very
/// campaign earlier comes back; otherwise units and linear responses that hold for both are linked
/// into a new folder. Tables of touch are linked as well.
/// @returns nothing where nothing had to move
/// @throws Error when a folder cannot be renamed or a file cannot be linked, or while another run
///         that holds the folder fills it with another campaign
std::optional<SetAside> set_aside_other_campaign(const std::filesystem::path& folder,
                                                 const StoreContent& content);

/// A body file among the snapshots would replace one of them.
/// @throws Error when `body` lies in the folder of the snapshots, or has its name
void refuse_among_snapshots(const std::filesystem::path& body, const std::filesystem::path& folder);

/// To be asked by a run once it holds the folder: before that, one with another description may
/// have made the folder its own.
/// @throws Error when the folder holds another campaign than `content`
void require_own_campaign(const std::filesystem::path& folder, const StoreContent& content);

}  // namespace palpable

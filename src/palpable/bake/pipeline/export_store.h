/// @file
/// Writes the snapshots of a store in the formats of other programs (docs/exchange.md).
#pragma once

#include "palpable/bake/campaign/snapshot_store.h"

#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace palpable {

struct WantedUnits {
  std::optional<int> site = {};  ///< of this site only; nothing: of all sites
  /// Values of parameters beyond site and level: of this combination only, with the middle value of
  /// a parameter that is not named. Empty: of all combinations.
  std::map<std::string, double> at = {};
};

/// Writes a grid for each unit and level: unit_00003_level_007.vtu.
/// @param wanted  which of the store's units are written
/// @param folder  created if absent
/// @throws Error if there is no such unit, a unit is missing or damaged, or a file cannot be
/// written
void export_store_to_vtu(const SnapshotStore& store, const WantedUnits& wanted,
                         const std::filesystem::path& folder);

/// Writes an array (levels x nodes x components) for each unit and field:
/// unit_00003_displacement.npy; and nodes.npy, levels.npy. Parameters and errors as above.
void export_store_to_numpy(const SnapshotStore& store, const WantedUnits& wanted,
                           const std::filesystem::path& folder);

}  // namespace palpable

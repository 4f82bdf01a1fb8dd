/// @file
/// Writes the snapshots of a store in the formats of other programs (docs/exchange.md).
#pragma once

#include "palpable/bake/campaign/snapshot_store.h"

#include <filesystem>
#include <optional>

namespace palpable {

/// Writes a grid for each unit and level: unit_00003_level_007.vtu.
/// @param site    writes the units of this site only; nothing: all sites
/// @param folder  created if absent
/// @returns the number of units written: 0 if there is no such site
/// @throws Error if a unit is missing or damaged, or a file cannot be written
int export_store_to_vtu(const SnapshotStore& store, std::optional<int> site,
                        const std::filesystem::path& folder);

/// Writes an array (levels x nodes x components) for each unit and field:
/// unit_00003_displacement.npy; and nodes.npy, levels.npy. Parameters and result as above.
int export_store_to_numpy(const SnapshotStore& store, std::optional<int> site,
                          const std::filesystem::path& folder);

}  // namespace palpable

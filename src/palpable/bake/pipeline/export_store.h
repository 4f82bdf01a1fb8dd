/// @file
/// The snapshots of a store in files of other programs (docs/exchange.md).
#pragma once

#include "palpable/bake/campaign/snapshot_store.h"

#include <filesystem>
#include <optional>

namespace palpable {

/// A grid for each unit and level: unit_00003_level_007.vtu.
/// @param site    only this one's units; nothing: all
/// @param folder  made if absent
/// @returns how many units were written: 0 if there is no such site
/// @throws Error if a unit is missing or damaged, or a file cannot be written
int export_store_to_vtu(const SnapshotStore& store, std::optional<int> site,
                        const std::filesystem::path& folder);

/// An array (levels x nodes x components) for each unit and field: unit_00003_displacement.npy; and
/// nodes.npy, levels.npy. The rest as above.
int export_store_to_numpy(const SnapshotStore& store, std::optional<int> site,
                          const std::filesystem::path& folder);

}  // namespace palpable

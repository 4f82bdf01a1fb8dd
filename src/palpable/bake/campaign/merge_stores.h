/// @file
/// Merges parts of a campaign that were solved separately into one store.
#pragma once

#include "palpable/bake/campaign/set_aside.h"
#include "palpable/common/base/progress.h"

#include <filesystem>
#include <vector>

namespace palpable {

/// Copies each unit from the first part that has it into `output`, which is created if absent and
/// may be one of the parts. The result equals the store of a single bake, byte for byte.
/// @throws Error when a part is not a store or belongs to another campaign, a unit is in none of
///         the parts (the message counts them and names the first), or the disk is full
CollectedStore merge_stores(const std::vector<std::filesystem::path>& parts,
                            const std::filesystem::path& output, const Progress& progress = {});

}  // namespace palpable

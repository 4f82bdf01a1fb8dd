/// @file
/// Parts of a campaign, solved apart, in one store.
#pragma once

#include "palpable/bake/campaign/set_aside.h"
#include "palpable/common/base/progress.h"

#include <filesystem>
#include <vector>

namespace palpable {

/// Copies each unit from the first part that has it into `output`, which is made if absent and may
/// be one of the parts. The result is what one bake of everything would have left, byte for byte.
/// @throws Error when a part is no store or of another campaign, units are in none of them (how
///         many, and which is the first), or the disk is full
CollectedStore merge_stores(const std::vector<std::filesystem::path>& parts,
                            const std::filesystem::path& output, const Progress& progress = {});

}  // namespace palpable

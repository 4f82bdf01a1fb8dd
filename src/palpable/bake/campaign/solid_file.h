/// @file
/// What a body was baked from, as numbers beside its body file: so that another solver, or the same
/// one later, can answer for the very same solid.
#pragma once

#include "palpable/bake/campaign/snapshot_store.h"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace palpable {

/// NAME.solid.h5 beside NAME.palpable: mesh, laws and constants of a body that was baked without a
/// campaign. A campaign holds the same in its campaign.h5 (docs/snapshots.md).
[[nodiscard]] std::filesystem::path solid_file_of(const std::filesystem::path& body_file);

/// Writes it aside, syncs it, and renames it into place.
/// @throws Error when it cannot be written
void write_solid_file(const std::filesystem::path& file, const StoreContent& content);

/// How a body file says that it was baked without a campaign (ReducedBody::method).
inline constexpr std::string_view kWithoutCampaign = "intrusive";

/// What was kept beside a body file of its solid: mesh, fixed, materials and material_of_element;
/// of NAME.solid.h5 where it was baked without a campaign, else of the campaign in NAME.snapshots.
/// Nothing where that is not there.
/// @param method  of the body
/// @throws Error when it cannot be read
[[nodiscard]] std::optional<StoreContent> solid_beside(const std::filesystem::path& body_file,
                                                       std::string_view method);

/// In what two solids differ: "another mesh: ...", "another support: ..." or "another material:
/// ...", for people. Empty: in nothing, to the last bit. Materials are compared where both know
/// theirs; supports that hold a node in some directions only are not kept and not compared.
[[nodiscard]] std::string solids_differ(const StoreContent& a, const StoreContent& b);

}  // namespace palpable

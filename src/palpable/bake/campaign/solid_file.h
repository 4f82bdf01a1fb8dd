/// @file
/// The solid that a body was baked from, in a file beside its body file, so that another solver, or
/// the same one later, can compute solutions of exactly the same solid.
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

/// Writes the file under a temporary name, syncs it and renames it.
/// @throws Error when it cannot be written
void write_solid_file(const std::filesystem::path& file, const StoreContent& content);

/// Value of ReducedBody::method in a body that was baked without a campaign.
inline constexpr std::string_view kWithoutCampaign = "intrusive";

/// Reads the solid of a body file (mesh, fixed, materials and material_of_element): from
/// NAME.solid.h5 where the body was baked without a campaign, else from the campaign in
/// NAME.snapshots. Nothing where that does not exist.
/// @param method  the body's ReducedBody::method
/// @throws Error when it cannot be read
[[nodiscard]] std::optional<StoreContent> solid_beside(const std::filesystem::path& body_file,
                                                       std::string_view method);

/// How two solids differ: "another mesh: ...", "another support: ..." or "another material: ...",
/// as text for the user. Empty: they are equal to the last bit. Materials are compared where both
/// are known; supports that hold a node in some directions only are neither stored nor compared.
[[nodiscard]] std::string solids_differ(const StoreContent& a, const StoreContent& b);

}  // namespace palpable

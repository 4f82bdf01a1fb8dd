/// @file
/// The content of a campaign as HDF5: the file campaign.h5 of a store (docs/snapshots.md).
#pragma once

#include "palpable/bake/campaign/snapshot_store.h"
#include "palpable/common/body_file/hdf5_tools.h"

#include <Eigen/Core>

#include <cstdint>
#include <string>

namespace palpable {

/// 16 hexadecimal digits.
[[nodiscard]] std::string key_text(std::uint64_t key);

/// @throws hdf5::Trouble as all functions below
void write_content(hid_t file, const StoreContent& content);

[[nodiscard]] StoreContent read_content(hid_t file);

/// Writes the solid alone, without its loads: mesh, support, laws and constants.
void write_solid(hid_t file, const StoreContent& content);

/// @param content  its mesh, fixed, materials and material_of_element are set; materials stay empty
///                 where the file has none
void read_solid(hid_t file, StoreContent& content);

/// A dataset of one column.
[[nodiscard]] Eigen::VectorXd read_column(hid_t file, const char* name);

}  // namespace palpable

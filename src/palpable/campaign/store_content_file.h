/// @file
/// What a campaign is about, as HDF5: the file campaign.h5 of a store (docs/snapshots.md).
#pragma once

#include "palpable/campaign/snapshot_store.h"
#include "palpable/reduced/hdf5_tools.h"

#include <Eigen/Core>

#include <cstdint>
#include <string>

namespace palpable {

/// 16 hexadecimal digits.
[[nodiscard]] std::string key_text(std::uint64_t key);

/// @throws hdf5::Trouble as all below
void write_content(hid_t file, const StoreContent& content);

[[nodiscard]] StoreContent read_content(hid_t file);

/// A dataset of one column.
[[nodiscard]] Eigen::VectorXd read_column(hid_t file, const char* name);

}  // namespace palpable

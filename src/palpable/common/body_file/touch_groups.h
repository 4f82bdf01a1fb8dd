/// @file
/// Writes and reads each touch table as a group of an open HDF5 file (docs/body_file.md): for body
/// files, and for the files in which a bake stores its finished tables.
///
/// Reading checks the sizes of datasets against each other; trouble_of() checks that indices are
/// within the skin and factors are numbers. All functions throw hdf5::Trouble.
#pragma once

#include "palpable/common/body_file/hdf5_tools.h"
#include "palpable/common/response/modal_tables.h"
#include "palpable/common/response/touch_tables.h"

#include <vector>

namespace palpable {

void write_group(hid_t group, const CoarseSkin& skin);
void write_group(hid_t group, const ComplianceTable& table);
void write_group(hid_t group, const RegionTable& table);
void write_group(hid_t group, const CrossTable& table);
void write_group(hid_t group, const ShellTable& table);
void write_group(hid_t group, const std::vector<HeldOutTouch>& touches);
void write_group(hid_t group, const VibrationTable& table);
void write_group(hid_t group, const ModalTables& tables);

void read_group(hid_t group, CoarseSkin& skin);
void read_group(hid_t group, ComplianceTable& table);
void read_group(hid_t group, RegionTable& table);
void read_group(hid_t group, CrossTable& table);
void read_group(hid_t group, ShellTable& table);
void read_group(hid_t group, std::vector<HeldOutTouch>& touches);
void read_group(hid_t group, VibrationTable& table);
void read_group(hid_t group, ModalTables& tables);

}  // namespace palpable

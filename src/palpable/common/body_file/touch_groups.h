/// @file
/// Each table of touch as a group of an HDF5 file that is open (docs/body_file.md): for the body
/// file, and for the files in which a bake keeps what it has finished.
///
/// Reading checks the sizes of datasets against each other; whether indices are within the skin and
/// factors are numbers is a question for trouble_of(). All throw hdf5::Trouble.
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
void write_group(hid_t group, const ModalTables& tables);

void read_group(hid_t group, CoarseSkin& skin);
void read_group(hid_t group, ComplianceTable& table);
void read_group(hid_t group, RegionTable& table);
void read_group(hid_t group, CrossTable& table);
void read_group(hid_t group, ShellTable& table);
void read_group(hid_t group, std::vector<HeldOutTouch>& touches);
void read_group(hid_t group, ModalTables& tables);

}  // namespace palpable

/// @file
/// Compares methods of reduction on the snapshots of a store, and bodies that are already reduced,
/// in one chart (exchange/method_page.h).
#pragma once

#include "palpable/bake/campaign/snapshot_store.h"
#include "palpable/bake/exchange/method_page.h"
#include "palpable/common/base/progress.h"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace palpable {

struct CompareSettings {
  std::vector<std::string> methods = {};  ///< names (method_names()); empty: all
  double tolerance = 1e-3;  ///< error at which a method stops: of all snapshots, or of a site's
  int max_modes = 1000;     ///< at which a method stops
  std::map<std::string, double> at = {};  ///< see point_of()
};

/// Applies the methods to the snapshots of one point; adds a line for each, and the provenance of
/// the snapshots.
/// @param prefix  of the lines' names
/// @throws Error if a unit is missing or damaged, or settings.at names what the store does not have
void add_store(const SnapshotStore& store, const std::string& prefix,
               const CompareSettings& settings, MethodPage& page, const Progress& progress = {});

/// Adds the errors that a body file states, against the number of its modes.
/// @throws Error if it cannot be read or does not say how its errors fall
void add_body(const std::filesystem::path& path, MethodPage& page);

}  // namespace palpable

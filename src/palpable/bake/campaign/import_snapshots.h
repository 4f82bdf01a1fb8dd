/// @file
/// Imports snapshots that another program has computed into a store: docs/snapshots.md, "Import".
#pragma once

#include "palpable/bake/campaign/import_checks.h"
#include "palpable/bake/campaign/set_aside.h"
#include "palpable/bake/describe/body_description.h"
#include "palpable/common/base/progress.h"

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace palpable {

/// A TOML file that says which file holds which snapshot.
struct ImportManifest {
  std::filesystem::path source;  ///< the TOML file
  std::filesystem::path body;    ///< the description of mesh, support, sites and parameters

  struct Field {
    std::string name;               ///< name in the store
    std::vector<std::string> from;  ///< fields in the files: one, or one for each component
    double unit = 1;                ///< SI value of 1 in the files
    std::string place;              ///< prefix of messages about it
  };
  std::vector<Field> fields;

  struct Snapshot {
    int site = 0;
    double level = 1;
    double force = 0;                               ///< N at this level; 0: not given
    std::map<std::string, double> at = {};          ///< values of the body's parameters
    std::filesystem::path file;                     ///< file with all fields; empty: see files
    std::map<std::string, std::string> files = {};  ///< field -> its own file
    std::string place;
  };
  std::vector<Snapshot> snapshots;
};

/// @throws Error naming file, line and key, as read_body_description()
[[nodiscard]] ImportManifest read_import_manifest(const std::filesystem::path& path);

/// The store, and what the law says of the imported stress.
struct ImportedStore {
  SnapshotStore store;
  std::optional<SetAside> set_aside = {};
  /// Of the first site at full load, or why stress was not judged.
  StressJudgement stress = {};
};

/// Reads all files and writes the store. Vectors and stresses are rotated as the mesh is (`up`).
/// Nodes are matched by number, or by position where a file has positions that do not fit its
/// numbers.
/// @param folder  of the files
/// @param output  folder of the store
/// @throws Error when a file cannot be read, lacks a field or nodes, a snapshot is missing or given
///         twice, a patch is not displaced further at a higher level, a node that the support holds
///         moves, or one moves beyond the range of the model (import_checks.h)
ImportedStore import_snapshots(const std::filesystem::path& folder, const ImportManifest& manifest,
                               const std::filesystem::path& output, const Progress& progress = {});

}  // namespace palpable

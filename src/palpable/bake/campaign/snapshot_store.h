/// @file
/// A campaign on disk: a folder with one HDF5 file per unit, and one, campaign.h5, that describes
/// the campaign. Layout: docs/snapshots.md.
///
///   N  nodes     V  vertices of the skin     S  sites     L  solved levels
///   P  points: all combinations of the values of the parameters beyond site and level, the last
///      parameter fastest
///   unit  one site at one point, number p S + s: the content of one file
#pragma once

#include "palpable/bake/campaign/site_run.h"
#include "palpable/bake/separate/reduction.h"
#include "palpable/common/geometry/digest.h"
#include "palpable/common/geometry/tet_mesh.h"
#include "palpable/common/material/material.h"
#include "palpable/common/reduced/reduced_body.h"

#include <Eigen/Core>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpable {

/// Version of the file layout.
inline constexpr int kSnapshotLayout = 0;
/// Number of linear responses in one file.
inline constexpr int kLinearRow = 64;

/// A parameter beyond site and level.
struct StoredParameter {
  std::string name;
  Eigen::VectorXd values;  ///< increasing; SI
};

/// A nodal field in the units' files.
struct StoredField {
  std::string name;    ///< "displacement", "stress", or any other
  int components = 3;  ///< per node
};

/// All that is known about a campaign before it is solved.
struct StoreContent {
  std::string name, material;       ///< for people, as in ReducedBody
  TetMesh mesh;                     ///< body frame, m
  std::vector<std::uint8_t> fixed;  ///< (V)
  /// The materials before parameters change them. Empty: unknown, in an older store.
  std::vector<Material> materials = {};
  std::vector<int> material_of_element = {};  ///< (E) index into materials
  std::vector<Site> sites;                    ///< (S) full loads are in the units
  Eigen::VectorXd levels;                     ///< (L + 1) 0 .. 1
  std::vector<StoredParameter> parameters;
  std::vector<StoredField> fields = {{"displacement", 3}, {"stress", 6}};
  std::vector<std::uint64_t> keys;  ///< (P S) see unit_keys()
  std::vector<int> linear;          ///< vertices of the skin whose linear response is stored
  std::uint64_t linear_key = 0;     ///< see linear_key()
  Provenance provenance;
  /// Default settings of a reduction of this store.
  ReductionSettings reduction = {.tolerance = default_tolerance(ReductionMethod::kPerSite),
                                 .weight_snapshots = true};

  [[nodiscard]] int site_count() const { return static_cast<int>(sites.size()); }
  [[nodiscard]] int level_count() const { return static_cast<int>(levels.size()) - 1; }
  [[nodiscard]] int unit_count() const { return static_cast<int>(keys.size()); }
  [[nodiscard]] int linear_file_count() const {
    return (static_cast<int>(linear.size()) + kLinearRow - 1) / kLinearRow;
  }
  [[nodiscard]] int point_count() const { return unit_count() / site_count(); }
  /// The values of all parameters at a point.
  [[nodiscard]] std::vector<double> values_at(int point) const;
};

/// Key of the whole campaign: a hash of the keys of its units and of its linear responses.
[[nodiscard]] std::uint64_t campaign_key(const StoreContent& content);

/// What a unit's file holds beside its fields.
struct StoredUnit {
  double full_load = 0;
  Eigen::VectorXd press_depth;  ///< (L + 1)
  double largest_von_mises = 0;
  SiteOutcome outcome;
  Eigen::Matrix3Xd rest;  ///< (3 x N) m: of the body at rest; no columns: zero
};

/// A store may be written by several processes at once, each unit by one of them. Files are written
/// under temporary names, synced and renamed, so a file that exists is complete. Members may be
/// called from several threads.
class SnapshotStore {
 public:
  /// Creates the folder if it is missing and writes campaign.h5. Units that are there already stay;
  /// their keys tell whether they are valid.
  /// @throws Error when the folder cannot be made or written, or holds something else
  static SnapshotStore create(std::filesystem::path folder, StoreContent content);

  /// The same without writing: for a process that is not the leader of its crew.
  static SnapshotStore attach(std::filesystem::path folder, StoreContent content);

  /// Opens an existing store. @throws Error when the folder is not a store, or is damaged
  static SnapshotStore open(std::filesystem::path folder);

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  [[nodiscard]] const StoreContent& content() const { return content_; }
  [[nodiscard]] std::filesystem::path unit_file(int unit) const;

  /// Whether the unit's file exists, is complete (its checksum is verified) and has the unit's key.
  [[nodiscard]] bool has(int unit) const;

  /// Why has() is false: "missing", "of another campaign ...", "truncated or damaged ..."; empty
  /// where it is true.
  [[nodiscard]] std::string why_not(int unit) const;

  /// @param rest    see StoredUnit
  /// @param others  (c N x L) each: the fields of content().fields that are neither displacement
  ///                nor stress, in their order
  /// @throws Error when it cannot be written, e.g. on a full disk
  void write(int unit, const SiteSnapshots& snapshots, const Eigen::Matrix3Xd& rest,
             const std::vector<Eigen::MatrixXf>& others = {}) const;

  /// Copies a unit's file from another store of the same campaign.
  void copy_from(const SnapshotStore& other, int unit) const;

  /// @pre has(unit) @throws Error when it cannot be read
  [[nodiscard]] StoredUnit unit(int unit) const;

  /// (count x L) rows first .. first + count - 1 of a field's snapshots, which have c N rows.
  /// @pre has(unit) @throws Error when it cannot be read
  [[nodiscard]] Eigen::MatrixXf rows(int unit, const StoredField& field, Eigen::Index first,
                                     Eigen::Index count) const;

  /// File k of the linear responses, of vertices content().linear[kLinearRow k ...], see
  /// solve_linear().
  [[nodiscard]] std::filesystem::path linear_file(int k) const;
  [[nodiscard]] bool has_linear(int k) const;
  void write_linear(int k, const Eigen::MatrixXf& responses) const;
  /// (3V x c) the linear responses of file k: displacement of all V vertices of the skin, m/N, a
  /// column for each of the file's vertices; c is kLinearRow, or less in the last file.
  /// @pre has_linear(k)
  [[nodiscard]] Eigen::MatrixXf linear(int k) const;
  void copy_linear_from(const SnapshotStore& other, int k) const;

  /// Folder in which a bake keeps tables of touch; may not exist.
  [[nodiscard]] std::filesystem::path touch_folder() const { return folder_ / "touch"; }

  /// To be called when all units exist: writes campaign.xdmf, which ParaView opens, and removes
  /// unfinished files of processes that no longer run. All other files stay.
  void finish() const;

 private:
  SnapshotStore(std::filesystem::path folder, StoreContent content);
  [[nodiscard]] std::string xdmf() const;

  std::filesystem::path folder_;
  StoreContent content_;
};

}  // namespace palpable

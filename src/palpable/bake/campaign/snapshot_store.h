/// @file
/// A campaign on disk: a folder with one HDF5 file per site, and one that says what it is about.
/// Layout: docs/snapshots.md.
///
///   N  nodes     V  vertices of the skin     S  sites     L  solved levels     P  points: values
///   of the parameters beyond site and level, in all combinations, the last parameter fastest unit
///   one site at one point, p S + s: what one file holds
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

inline constexpr int kSnapshotLayout = 0;
/// Linear responses in one file.
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
  /// Where parameters stretch a material, that without them. None: an older store, not known.
  std::vector<Material> materials = {};
  std::vector<int> material_of_element = {};  ///< (E) index into materials
  std::vector<Site> sites;                    ///< (S) full loads are in the units
  Eigen::VectorXd levels;                     ///< (L + 1) 0 .. 1
  std::vector<StoredParameter> parameters;
  std::vector<StoredField> fields = {{"displacement", 3}, {"stress", 6}};
  std::vector<std::uint64_t> keys;  ///< (P S) what each unit was computed from
  std::vector<int> linear;          ///< vertices of the skin whose linear response is stored, too
  std::uint64_t linear_key = 0;     ///< what those were computed from
  std::vector<std::pair<std::string, std::string>> provenance;
  /// Asked for, unless somebody asks otherwise.
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

/// What the whole campaign is computed from: that of its units and of its linear responses.
[[nodiscard]] std::uint64_t campaign_key(const StoreContent& content);

/// What a unit's file holds beside its fields.
struct StoredUnit {
  double full_load = 0;
  Eigen::VectorXd press_depth;  ///< (L + 1)
  double largest_von_mises = 0;
  SiteOutcome outcome;
  Eigen::Matrix3Xd rest;  ///< (3 x N) m: the body that nobody presses; no columns: undeformed
};

/// A store may be written by several processes at once, each unit by one of them: files are written
/// aside, synced and renamed, and what is there is whole. Members may be called from several
/// threads.
class SnapshotStore {
 public:
  /// Makes the folder where it is missing and writes what the campaign is about. Units that are
  /// there already stay; whether they are valid is a question of their keys.
  /// @throws Error when the folder cannot be made or written, or holds something else
  static SnapshotStore create(std::filesystem::path folder, StoreContent content);

  /// The same without writing: for a process that is not the leader of its crew.
  static SnapshotStore attach(std::filesystem::path folder, StoreContent content);

  /// Opens a store that exists. @throws Error when it is none, or damaged
  static SnapshotStore open(std::filesystem::path folder);

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  [[nodiscard]] const StoreContent& content() const { return content_; }
  [[nodiscard]] std::filesystem::path unit_file(int unit) const;

  /// Whether the unit's file is there, whole (its checksum is computed anew) and has the unit's
  /// key.
  [[nodiscard]] bool has(int unit) const;

  /// Why has() says no: "missing", "of another campaign ...", "truncated or damaged ...".
  [[nodiscard]] std::string why_not(int unit) const;

  /// @param rest    see StoredUnit
  /// @param others  (c N x L) each, those of content().fields that are neither displacement nor
  ///                stress, in their order
  /// @throws Error when it cannot be written, e.g. on a full disk
  void write(int unit, const SiteSnapshots& snapshots, const Eigen::Matrix3Xd& rest,
             const std::vector<Eigen::MatrixXf>& others = {}) const;

  /// Takes over a whole file of a store of the same campaign.
  void copy_from(const SnapshotStore& other, int unit) const;

  /// @pre has(unit) @throws Error when it cannot be read
  [[nodiscard]] StoredUnit unit(int unit) const;

  /// (count x L) rows first .. first + count - 1 of a field's snapshots, which have c N rows.
  /// @pre has(unit) @throws Error when it cannot be read
  [[nodiscard]] Eigen::MatrixXf rows(int unit, const StoredField& field, Eigen::Index first,
                                     Eigen::Index count) const;

  /// Linear responses: those of vertices content().linear[kLinearRow k ...], see solve_linear().
  [[nodiscard]] std::filesystem::path linear_file(int k) const;
  [[nodiscard]] bool has_linear(int k) const;
  void write_linear(int k, const Eigen::MatrixXf& responses) const;
  /// (3V x kLinearRow, fewer in the last) m/N. @pre has_linear(k)
  [[nodiscard]] Eigen::MatrixXf linear(int k) const;
  void copy_linear_from(const SnapshotStore& other, int k) const;

  /// Where a bake keeps tables of touch; may be missing.
  [[nodiscard]] std::filesystem::path touch_folder() const { return folder_ / "touch"; }

  /// When all units are there: writes campaign.xdmf, which ParaView opens, and removes the
  /// unfinished files that killed processes left behind. Whatever else lies in the folder stays.
  void finish() const;

 private:
  SnapshotStore(std::filesystem::path folder, StoreContent content);
  [[nodiscard]] std::string xdmf() const;

  std::filesystem::path folder_;
  StoreContent content_;
};

}  // namespace palpable

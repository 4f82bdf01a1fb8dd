/// @file
/// Tables of touch that are finished, one file each: a bake that was stopped goes on with them, and
/// a description that was edited uses again what still holds (docs/snapshots.md).
#pragma once

#include "palpable/bake/touch_bake/skin_response.h"
#include "palpable/common/response/held_out_touch.h"
#include "palpable/common/response/touch_tables.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpable {

struct TouchBakeSettings;

/// What each kind of table is computed from, as one number: revision of the makers, mesh, laws and
/// constants, support, the state in which the body is, and the settings that the table hangs on.
struct TouchKeys {
  std::uint64_t compliance = 0;
  std::uint64_t regions = 0;  ///< of one it also hangs on the vertex
  std::uint64_t cross = 0;
  std::uint64_t shell = 0;
  std::uint64_t held_out = 0;  ///< of all these, see held_out_key(); 0: there are no touches

  [[nodiscard]] bool operator==(const TouchKeys&) const = default;
};

/// Of tables; of held-out touches there is no key yet.
[[nodiscard]] TouchKeys touch_keys(const SkinResponse& skin, const TouchBakeSettings& settings);

/// Held-out touches by their numbers: those that are solved.
using SolvedTouches = std::vector<std::optional<HeldOutTouch>>;
/// What a body file has of them: those that the full solver could follow to their depth.
[[nodiscard]] std::vector<HeldOutTouch> followed(const SolvedTouches& touches);

/// A folder of such files. Each is written aside, synced and renamed, so that a file with its name
/// is whole. Members may be called from several threads.
class TouchStore {
 public:
  /// The folder is made with the first file.
  explicit TouchStore(std::filesystem::path folder) : folder_(std::move(folder)) {}

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

  /// A table that was kept; nothing where there is none, it is damaged, or of another key.
  [[nodiscard]] std::optional<ComplianceTable> find_compliance(const TouchKeys& keys) const;
  [[nodiscard]] std::optional<RegionTable> find_region(const TouchKeys& keys, int vertex) const;
  [[nodiscard]] std::optional<CrossTable> find_cross(const TouchKeys& keys) const;
  [[nodiscard]] std::optional<ShellTable> find_shell(const TouchKeys& keys) const;
  [[nodiscard]] std::optional<SolvedTouches> find_held_out(const TouchKeys& keys) const;

  /// @throws Error when the file cannot be written, e.g. on a full disk
  void keep(const TouchKeys& keys, const ComplianceTable& table) const;
  void keep(const TouchKeys& keys, const RegionTable& table) const;
  void keep(const TouchKeys& keys, const CrossTable& table) const;
  void keep(const TouchKeys& keys, const ShellTable& table) const;
  void keep(const TouchKeys& keys, const SolvedTouches& touches) const;

  /// States that these tables are complete, for whoever knows no keys but that of a campaign:
  /// `bake` does, `reduce` looks there.
  /// @param of  what the campaign is computed from
  void keep_list(std::uint64_t of, const TouchKeys& keys, const TouchTables& tables) const;
  /// The tables of that list; nothing if there is none, it is of another campaign, or a table that
  /// it names is not there any more.
  [[nodiscard]] std::optional<TouchTables> find_listed(std::uint64_t of) const;

  /// Removes what killed processes have left of files that they were writing.
  void remove_leftovers() const;

 private:
  std::filesystem::path folder_;
};

}  // namespace palpable

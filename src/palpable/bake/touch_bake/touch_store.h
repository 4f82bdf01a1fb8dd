/// @file
/// Stores finished touch tables, one file each. An interrupted bake continues with them, and after
/// an edit of the description those that are still valid are used again (docs/snapshots.md).
#pragma once

#include "palpable/bake/touch_bake/skin_response.h"
#include "palpable/common/response/stated_error.h"
#include "palpable/common/response/touch_tables.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpable {

struct TouchBakeSettings;

/// For each kind of table a digest of everything that it is computed from: revision of the makers,
/// mesh, material laws and constants, support, preloaded state, and the settings that affect the
/// table. A stored table is used only if its key is the same.
struct TouchKeys {
  std::uint64_t compliance = 0;
  std::uint64_t regions = 0;  ///< common to all; a region's own key also includes its vertex
  std::uint64_t cross = 0;
  std::uint64_t shell = 0;
  std::uint64_t vibration = 0;  ///< 0: the body has no density, or wants no modes
  std::uint64_t held_out = 0;   ///< of the held-out touches, held_out_key(); 0: there are none

  [[nodiscard]] bool operator==(const TouchKeys&) const = default;
};

/// The keys of a body's tables. TouchKeys::held_out stays 0: it needs the finished tables.
[[nodiscard]] TouchKeys touch_keys(const SkinResponse& skin, const TouchBakeSettings& settings);

/// Held-out touches by their numbers; nothing for those that are not solved yet.
using SolvedTouches = std::vector<std::optional<HeldOutTouch>>;
/// The touches that go into a body file: those that the full solver could follow to their depth.
[[nodiscard]] std::vector<HeldOutTouch> followed(const SolvedTouches& touches);

/// A folder of stored tables. Each file is written under another name, synced and renamed, so that
/// a file under its final name is always complete. Members may be called from several threads.
class TouchStore {
 public:
  /// The folder is created with the first file.
  explicit TouchStore(std::filesystem::path folder) : folder_(std::move(folder)) {}

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

  /// The stored table; nothing if there is none, it is damaged, or it has another key.
  [[nodiscard]] std::optional<ComplianceTable> find_compliance(const TouchKeys& keys) const;
  [[nodiscard]] std::optional<RegionTable> find_region(const TouchKeys& keys, int vertex) const;
  [[nodiscard]] std::optional<CrossTable> find_cross(const TouchKeys& keys) const;
  [[nodiscard]] std::optional<ShellTable> find_shell(const TouchKeys& keys) const;
  [[nodiscard]] std::optional<VibrationTable> find_vibration(const TouchKeys& keys) const;
  [[nodiscard]] std::optional<SolvedTouches> find_held_out(const TouchKeys& keys) const;

  /// @throws Error when the file cannot be written, e.g. on a full disk
  void keep(const TouchKeys& keys, const ComplianceTable& table) const;
  void keep(const TouchKeys& keys, const RegionTable& table) const;
  void keep(const TouchKeys& keys, const CrossTable& table) const;
  void keep(const TouchKeys& keys, const ShellTable& table) const;
  void keep(const TouchKeys& keys, const VibrationTable& table) const;
  void keep(const TouchKeys& keys, const SolvedTouches& touches) const;

  /// Writes a list that names the keys of a campaign's complete tables. `bake` writes it, so that
  /// `reduce`, which has only the key of the campaign, can find the tables.
  /// @param of     the key of the campaign
  /// @param stage  of the bake, a word of its own; empty: it is finished
  void keep_list(std::uint64_t of, const TouchKeys& keys, const TouchTables& tables,
                 const std::string& stage = {}) const;
  /// The stage of the list of a campaign; empty where there is no list, or it says none.
  [[nodiscard]] std::string listed_stage(std::uint64_t of) const;
  /// The tables on the list of a campaign; nothing if there is no list, it belongs to another
  /// campaign, or one of its tables is missing.
  [[nodiscard]] std::optional<TouchTables> find_listed(std::uint64_t of) const;

  /// Removes incomplete files that killed processes have left behind.
  void remove_leftovers() const;

 private:
  std::filesystem::path folder_;
};

}  // namespace palpable

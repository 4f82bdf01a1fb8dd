/// @file
/// The files of a run, with a camera or without.
#pragma once

#include "palpable/common/base/folder_lock.h"
#include "palpable/live/live_writer/live_output.h"
#include "palpable/live/live_writer/live_summary.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpable {

/// The output folder of one run; no other run writes into it meanwhile.
class RunFolder {
 public:
  /// @param folder     empty: nothing is written
  /// @param overwrite  whether the files of an earlier run may be replaced
  /// @param inputs     files and folders that the run reads; it removes none of them
  /// @throws Error when the folder is not available
  RunFolder(const std::filesystem::path& folder, bool overwrite,
            const std::vector<std::filesystem::path>& inputs);

  /// Begins to write; null if nothing is written. To be called after the first frame was processed,
  /// because it removes an earlier run's files.
  [[nodiscard]] std::unique_ptr<LiveOutput> begin(const LiveOutputSettings& settings) const;

  /// Writes live.json beside the finished output.
  void write(const LiveSummary& summary) const;

  /// The files that the run has left, in lines; and what the disk was too slow for.
  /// @param remedy  against a slow disk, such as "--every-frame waits for it"; empty: none
  [[nodiscard]] std::string text_of(const LiveOutput& output, std::string_view remedy = {}) const;

 private:
  std::filesystem::path folder_;
  std::optional<FolderLock> lock_;
  bool replaces_ = false;  // an earlier run in the folder
};

}  // namespace palpable

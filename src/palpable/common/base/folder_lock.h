/// @file
/// Locks that let one program at a time write into a folder, or several that cooperate, and one at
/// a time make a file.
#pragma once

#include <filesystem>
#include <vector>

namespace palpable {

enum class Holding {
  kAlone,       ///< exclusive
  kWithOthers,  ///< shared: excludes holders with kAlone, but not others with kWithOthers
};

/// Locks a folder, and creates it if it is missing. The operating system releases the lock when the
/// program ends, even if it is killed; no lock file can be left behind. On a file system that
/// cannot lock folders (NFS) two programs are not kept apart.
class FolderLock {
 public:
  /// @throws Error when another program, or another lock of this one, holds the folder and one of
  /// the two is kAlone, or when the folder cannot be created
  explicit FolderLock(const std::filesystem::path& folder, Holding holding = Holding::kAlone);
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  /// Removes the folders that the constructor created, if they are still empty.
  ~FolderLock();

 private:
  std::vector<std::filesystem::path> made_;  // innermost first
  int descriptor_ = -1;
};

/// "FILE.lock", which OutputLock makes beside a file.
[[nodiscard]] std::filesystem::path lock_beside(const std::filesystem::path& file);

/// Lets one program at a time make a file, by a locked empty file beside it. The operating system
/// releases the lock when the program ends, even if it is killed; the empty file is then left
/// behind, and the next holder takes it over. Programs on a file system that cannot lock (NFS) are
/// not kept apart.
class OutputLock {
 public:
  /// @throws Error "FILE: another run is making it ..." while another holds the lock
  explicit OutputLock(const std::filesystem::path& file);
  OutputLock(const OutputLock&) = delete;
  OutputLock& operator=(const OutputLock&) = delete;
  /// Removes the file beside, unless somebody's content is in it.
  ~OutputLock();

 private:
  std::filesystem::path beside_;
  int descriptor_ = -1;  // -1: nothing could be locked
};

}  // namespace palpable

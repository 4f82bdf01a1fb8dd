/// @file
/// A lock that lets one program at a time write into a folder, or several that cooperate.
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

}  // namespace palpable

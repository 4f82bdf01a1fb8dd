/// @file
/// One program at a time writes into a folder, or several that agree.
#pragma once

#include <filesystem>
#include <vector>

namespace palpable {

enum class Holding {
  kAlone,
  kWithOthers,  ///< several may hold it so, and none of them lets somebody hold it alone
};

/// Holds a folder, which is made where it is missing. The system holds the lock for the program and
/// lets it go when the program ends, killed or not; there is no file that could stay behind. A
/// file system that cannot lock folders (NFS) does not keep two programs apart.
class FolderLock {
 public:
  /// @throws Error when another program, or another lock of this one, holds the folder and one of
  /// the two wants to be alone, or when it cannot be made
  explicit FolderLock(const std::filesystem::path& folder, Holding holding = Holding::kAlone);
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  /// Removes the folders that it made, where they are still empty.
  ~FolderLock();

 private:
  std::vector<std::filesystem::path> made_;  // innermost first
  int descriptor_ = -1;
};

}  // namespace palpable

/// @file
/// A folder for temporary files.
#pragma once

#include <filesystem>
#include <string_view>

namespace palpable {

/// Created in the system's folder for temporary files. The destructor removes it with everything in
/// it, also after an error.
class TemporaryFolder {
 public:
  /// @param name  its name begins with this
  /// @throws Error if it cannot be made
  explicit TemporaryFolder(std::string_view name);
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder();

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace palpable

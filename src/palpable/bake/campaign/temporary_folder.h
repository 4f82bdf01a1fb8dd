/// @file
/// A folder for files that nobody wants to keep.
#pragma once

#include <filesystem>
#include <string_view>

namespace palpable {

/// Made under the system's folder for temporary files, removed with all it holds by the destructor,
/// also when something fails.
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

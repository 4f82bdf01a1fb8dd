#include "palpable/common/base/own_files.h"

#include "palpable/common/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <string>
#include <system_error>
#include <utility>

namespace palpable {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLeastDigits = 6;

bool is_digit(char c) { return '0' <= c && c <= '9'; }

// Whether one part of a path fits one part of a pattern.
bool part_fits(std::string_view part, std::string_view pattern) {
  if (pattern == "*") return true;
  const std::size_t number = pattern.find('#');
  if (number == std::string_view::npos) return part == pattern;
  const std::string_view before = pattern.substr(0, number);
  const std::string_view after = pattern.substr(number + 1);
  if (part.size() < before.size() + after.size() + kLeastDigits) return false;
  if (!part.starts_with(before) || !part.ends_with(after)) return false;
  part.remove_prefix(before.size());
  part.remove_suffix(after.size());
  return std::all_of(part.begin(), part.end(), is_digit);
}

// The entries of a folder that fit one part of a pattern, sorted.
std::vector<fs::path> entries_that_fit(const fs::path& folder, std::string_view pattern) {
  std::vector<fs::path> found;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (part_fits(entry.path().filename().string(), pattern)) found.push_back(entry.path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

// Calls `use` with the files of a pattern, and `leave` with the folders on the way, inner ones
// first.
void visit(const fs::path& folder, std::string_view pattern,
           const std::function<void(const fs::path&)>& use,
           const std::function<void(const fs::path&)>& leave) {
  const std::size_t slash = pattern.find('/');
  std::error_code error;
  if (slash == std::string_view::npos) {
    for (const fs::path& file : entries_that_fit(folder, pattern)) {
      if (!fs::is_directory(file, error)) use(file);
    }
    return;
  }
  for (const fs::path& inner : entries_that_fit(folder, pattern.substr(0, slash))) {
    if (!fs::is_directory(fs::symlink_status(inner, error))) continue;
    visit(inner, pattern.substr(slash + 1), use, leave);
    leave(inner);
  }
}

}  // namespace

std::vector<fs::path> own_files(const fs::path& folder, OwnNames names) {
  std::vector<fs::path> files;
  for (const std::string_view name : names) {
    visit(
        folder, name, [&](const fs::path& file) { files.push_back(file); }, [](const fs::path&) {});
  }
  return files;
}

void remove_own_files(const fs::path& folder, OwnNames names) {
  const auto remove = [](const fs::path& file) {
    std::error_code error;
    fs::remove(file, error);
    if (error) {
      throw Error(fmt::format("{}: cannot be removed: {}", file.string(), error.message()));
    }
  };
  const auto remove_if_empty = [](const fs::path& inner) {
    std::error_code ignored;  // it is not empty
    fs::remove(inner, ignored);
  };
  for (auto name = names.rbegin(); name != names.rend(); ++name) {
    visit(folder, *name, remove, remove_if_empty);
  }
}

}  // namespace palpable

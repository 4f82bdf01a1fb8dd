#include "palpable/base/output_file.h"

#include "palpable/base/error.h"

#include <fmt/core.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

namespace palpable {
namespace {

namespace fs = std::filesystem;

// As many links as Linux follows before it says that they run in a circle.
constexpr int kMostLinks = 40;

// @param output  as it was given, for the message
void expect_folder_above(const fs::path& output, const fs::path& at) {
  std::error_code error;
  // Fails where the working folder itself is gone.
  const fs::path folder = fs::absolute(at, error).parent_path();
  if (error) throw Error(fmt::format("{}: its folder does not exist", output.string()));
  if (!fs::is_directory(folder, error)) {
    throw Error(fmt::format("{}: the folder {} does not exist", output.string(), folder.string()));
  }
}

}  // namespace

void expect_writable(const fs::path& file) {
  std::error_code error;
  const bool was_there = fs::exists(file, error);
  const bool can_be = std::ofstream(file, std::ios::app).good();
  if (!was_there) fs::remove(file, error);
  if (!can_be) throw Error(fmt::format("{}: cannot be written", file.string()));
}

bool lies_in(const fs::path& path, const fs::path& folder) {
  std::error_code error;
  const fs::path inner = fs::weakly_canonical(fs::absolute(path, error), error);
  const fs::path outer = fs::weakly_canonical(fs::absolute(folder, error), error);
  if (inner.empty() || outer.empty()) return false;  // the working folder is gone
  const fs::path relative = inner.lexically_relative(outer);
  return !relative.empty() && *relative.begin() != "..";
}

fs::path behind_links(const fs::path& file) {
  fs::path at = file;
  std::error_code error;
  for (int links = 0; links < kMostLinks && fs::is_symlink(at, error); ++links) {
    const fs::path next = fs::read_symlink(at, error);
    if (error) break;
    at = next.is_absolute() ? next : at.parent_path() / next;
  }
  return at;
}

void guard_output_file(const fs::path& output, const std::vector<fs::path>& inputs) {
  const fs::path file = behind_links(output);
  expect_folder_above(output, file);
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (fs::is_directory(status) || !file.has_filename()) {
    throw Error(fmt::format("{}: is a folder, and the output is a file; name the file in it",
                            output.string()));
  }
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    throw Error(
        fmt::format("{}: is no ordinary file and is not replaced; name a file", output.string()));
  }
  for (const fs::path& input : inputs) {
    if (input.empty()) continue;
    // A new file in an input folder destroys nothing.
    if (fs::exists(status) && (fs::equivalent(input, file, error) || lies_in(file, input))) {
      throw Error(fmt::format("{}: is read as input ({}) and would be destroyed; name another file",
                              output.string(), input.string()));
    }
  }
}

void guard_output_folder(const fs::path& output, const std::vector<fs::path>& inputs) {
  // "out/" is "out", and stands in the folder above.
  const fs::path folder = behind_links(output.has_filename() ? output : output.parent_path());
  expect_folder_above(output, folder);
  std::error_code error;
  const fs::file_status status = fs::status(folder, error);
  if (fs::exists(status) && !fs::is_directory(status)) {
    throw Error(
        fmt::format("{}: is a file, and the output is a folder; name another", output.string()));
  }
  for (const fs::path& input : inputs) {
    if (input.empty()) continue;
    if (lies_in(input, folder) || (fs::exists(status) && lies_in(folder, input))) {
      throw Error(
          fmt::format("{}: what is read as input ({}) could be destroyed; name a folder "
                      "that has nothing to do with it",
                      output.string(), input.string()));
    }
  }
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw Error(fmt::format("{}: cannot be made: {}", folder.string(), error.message()));
}

void write_text_file(const fs::path& file, std::string_view text) {
  errno = 0;
  std::ofstream out(file, std::ios::binary);
  out.write(text.data(), static_cast<std::streamsize>(text.size()));
  out.close();
  if (!out) {
    throw Error(fmt::format("{}: cannot be written: {}", file.string(),
                            errno != 0 ? std::strerror(errno) : "unknown reason"));
  }
}

}  // namespace palpable

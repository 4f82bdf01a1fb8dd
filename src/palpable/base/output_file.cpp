#include "palpable/base/output_file.h"

#include "palpable/base/error.h"

#include <fmt/core.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

namespace palpable {

void expect_writable(const std::filesystem::path& file) {
  std::error_code error;
  const bool was_there = std::filesystem::exists(file, error);
  const bool can_be = std::ofstream(file, std::ios::app).good();
  if (!was_there) std::filesystem::remove(file, error);
  if (!can_be) throw Error(fmt::format("{}: cannot be written", file.string()));
}

void expect_folder_of(const std::filesystem::path& output) {
  const std::filesystem::path folder = std::filesystem::absolute(output).parent_path();
  if (!std::filesystem::is_directory(folder)) {
    throw Error(fmt::format("{}: the folder {} does not exist", output.string(), folder.string()));
  }
}

void make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw Error(fmt::format("{}: cannot be made: {}", folder.string(), error.message()));
}

void write_text_file(const std::filesystem::path& file, std::string_view text) {
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

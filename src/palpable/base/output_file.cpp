#include "palpable/base/output_file.h"

#include "palpable/base/error.h"

#include <fmt/core.h>

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

}  // namespace palpable

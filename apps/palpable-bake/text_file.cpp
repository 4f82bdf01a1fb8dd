#include "apps/palpable-bake/text_file.h"

#include "palpable/base/error.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>

namespace palpable::app {

std::filesystem::path table_beside(const std::filesystem::path& page) {
  std::filesystem::path table = page;
  table.replace_extension(".csv");
  if (table == page) {
    throw Error(fmt::format("{}: is where the table goes; call the page {}.html", page.string(),
                            page.stem().string()));
  }
  return table;
}

void write_text_file(const std::filesystem::path& path, std::string_view text) {
  errno = 0;
  std::ofstream file(path, std::ios::binary);
  file.write(text.data(), static_cast<std::streamsize>(text.size()));
  file.close();
  if (!file) {
    throw Error(fmt::format("{}: cannot be written: {}", path.string(),
                            errno != 0 ? std::strerror(errno) : "unknown reason"));
  }
}

}  // namespace palpable::app

#include "apps/palpable-bake/table_beside.h"

#include "palpable/base/error.h"

#include <fmt/format.h>

#include <fstream>
#include <string>
#include <system_error>

namespace palpable::app {

std::filesystem::path table_beside(const std::filesystem::path& page) {
  std::filesystem::path table = page;
  table.replace_extension(".csv");
  if (table == page) {
    throw Error(fmt::format("{}: is where the table goes; call the page {}.html", page.string(),
                            page.stem().string()));
  }
  std::error_code error;
  if (!std::filesystem::is_regular_file(table, error)) return table;
  std::string start(40, '\0');
  std::ifstream in(table, std::ios::binary);
  in.read(start.data(), static_cast<std::streamsize>(start.size()));
  // As report and compare begin theirs (body_table(), method_table()).
  if (start.starts_with("quantity,field,modes,") || start.starts_with("field,method,source,")) {
    return table;
  }
  throw Error(
      fmt::format("{}: is somebody's, and where the numbers of the page go; give the page another "
                  "name with -o",
                  table.string()));
}

}  // namespace palpable::app

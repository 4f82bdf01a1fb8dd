#include "palpable/exchange/heavy_file.h"

#include "palpable/base/error.h"
#include "palpable/base/markup_text.h"
#include "palpable/reduced/hdf5_tools.h"

#include <fmt/core.h>

namespace palpable {

void write_heavy_and_light(const std::filesystem::path& heavy,
                           const std::function<void(hid_t file)>& fill,
                           const std::filesystem::path& light_path, const std::string& light) {
  // The light one names it in XML.
  const std::string name = heavy.filename().string();
  if (!fits_in_markup(name) || name.find('\n') != std::string::npos) {
    throw Error(fmt::format(
        "{}: XML cannot hold this name (no UTF-8, or a control character in it); choose another",
        heavy.string()));
  }
  const hdf5::Quiet quiet;
  const auto write_light = [&] {
    try {
      hdf5::write_durably(light_path, light);
    } catch (const hdf5::Trouble& trouble) {
      throw Error(fmt::format("{}: {}", light_path.string(), trouble.what));
    }
  };
  try {
    hdf5::write_file(heavy, fill, write_light);
  } catch (const hdf5::Trouble& trouble) {
    throw Error(fmt::format("{}: {}", heavy.string(), trouble.what));
  }
}

}  // namespace palpable

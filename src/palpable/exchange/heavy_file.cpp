#include "palpable/exchange/heavy_file.h"

#include "palpable/base/error.h"
#include "palpable/reduced/hdf5_tools.h"

#include <fmt/core.h>

namespace palpable {

void write_heavy_and_light(const std::filesystem::path& heavy,
                           const std::function<void(hid_t file)>& fill,
                           const std::filesystem::path& light_path, const std::string& light) {
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

#include "palpable/bake/exchange/heavy_file.h"

#include "palpable/common/base/error.h"
#include "palpable/common/base/markup_text.h"
#include "palpable/common/body_file/hdf5_tools.h"

#include <fmt/core.h>

#include <system_error>

namespace palpable {

std::filesystem::path heavy_beside(const std::filesystem::path& light) {
  std::filesystem::path heavy = light;
  heavy += ".h5";
  std::error_code error;
  if (std::filesystem::exists(heavy, error) && !std::filesystem::exists(light, error)) {
    throw Error(fmt::format(
        "{}: is there without {}, so it is somebody's, and it is where the numbers go; choose "
        "another name",
        heavy.string(), light.filename().string()));
  }
  return heavy;
}

void write_heavy_and_light(const std::filesystem::path& heavy,
                           const std::function<void(hid_t file)>& fill,
                           const std::filesystem::path& light_path, const std::string& light) {
  // The light file contains this name as XML text.
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

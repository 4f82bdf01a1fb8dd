#include "apps/palpable/bake_program.h"

#include "palpable/base/error.h"

#include <system_error>

namespace palpable::app {

std::filesystem::path bake_program() {
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  if (error) throw Error("the folder of this program is not known: " + error.message());
  return self.parent_path() / "palpable-bake";
}

}  // namespace palpable::app

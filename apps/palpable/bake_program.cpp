#include "apps/palpable/bake_program.h"

#include "palpable/base/this_machine.h"

namespace palpable::app {

std::filesystem::path bake_program() { return folder_of_program() / "palpable-bake"; }

}  // namespace palpable::app

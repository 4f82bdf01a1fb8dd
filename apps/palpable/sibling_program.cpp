#include "apps/palpable/sibling_program.h"

#include "palpable/common/base/this_machine.h"

namespace palpable::app {

std::filesystem::path sibling_program(std::string_view name) { return folder_of_program() / name; }

}  // namespace palpable::app

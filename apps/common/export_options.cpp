#include "apps/common/export_options.h"

namespace palpable::app {

void add_inline_option(Command command, std::string& holds_all) {
  command
      .add_option("--inline", holds_all,
                  "page: whether it is one file with everything in it, which opens from a disk; "
                  "auto: if its bodies have 16 MB at most")
      .one_of({"auto", "always", "never"})
      .show_default();
}

}  // namespace palpable::app

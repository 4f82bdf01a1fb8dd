// palpable-bake about: the libraries that the offline half runs with. palpable doctor asks for it.

#include "apps/common/command_line.h"
#include "apps/common/printing.h"
#include "apps/palpable-bake/commands.h"
#include "palpable/bake/separate/dense_algebra.h"

namespace palpable::app {

void add_about(Command app) {
  Command command = app.add_subcommand("about", "The version and the libraries of this program");
  command.footer("Prints one JSON object.\nExample: palpable-bake about");
  command.callback([] {
    const BlasFacts blas = blas_facts();
    print_json({{"version", PALPABLE_VERSION},
                {"blas", blas.name},
                {"blas_kernels", blas.kernels},
                {"blas_is_thread_safe", blas.thread_safe}});
  });
}

}  // namespace palpable::app

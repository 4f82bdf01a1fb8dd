// palpable serve DIR: shows a page to browsers on this machine.

#include "apps/common/command_line.h"
#include "apps/common/printing.h"
#include "apps/palpable/commands.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/standard_streams.h"
#include "palpable/live/page/folder_server.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>

namespace palpable::app {
namespace {

struct ServeOptions {
  std::filesystem::path folder;
  int port = 8080;
};

void serve(const ServeOptions& options) {
  if (!std::filesystem::exists(options.folder / "index.html")) {
    throw Error(
        fmt::format("{}: holds no index.html; palpable export BODY --to page -o {} writes "
                    "a page",
                    options.folder.string(), options.folder.string()));
  }
  FolderServer server(options.folder, options.port);
  print_text("http://127.0.0.1:{}/   Ctrl+C ends\n", server.port());
  if (const std::string why = flush_standard_output(); !why.empty()) throw Error(why);
  server.run();
}

}  // namespace

void add_serve(Command app) {
  const auto options = std::make_shared<ServeOptions>();
  Command command = app.add_subcommand("serve", "Show a page to browsers on this machine");
  command.add_option("folder", options->folder, "Folder of a page (palpable export --to page)")
      .required()
      .existing_folder()
      .type_name("DIR");
  command.add_option("--port", options->port, "Port on 127.0.0.1; 0: any free one")
      .in_range(0, 65535)
      .show_default();
  command.footer(
      "Other machines cannot connect. A page whose bodies have 16 MB at most needs no server.\n"
      "Example: palpable serve bunny-page");
  command.callback([options] { serve(*options); });
}

}  // namespace palpable::app

// palpable inspect: prints the content of a body file.

#include "apps/common/command_line.h"
#include "apps/common/printing.h"
#include "apps/palpable/commands.h"
#include "apps/palpable/installed.h"
#include "palpable/common/base/error.h"
#include "palpable/common/body_file/body_facts.h"
#include "palpable/common/body_file/touch_file.h"
#include "palpable/common/body_file/touch_text.h"

#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <optional>

namespace palpable::app {
namespace {

struct InspectOptions {
  std::filesystem::path body;
  bool json = false;
};

void print_facts(const ReducedBody& body, const std::string& touch,
                 const std::filesystem::path& path) {
  for (const auto& [name, text] : body_facts(body, path, "--set")) {
    print_text("{:<20}{}\n", name, text);
  }
  print_text("{:<20}{}\n", "touch", touch);
  print_text(
      "errors are relative, L2; lengths, loads and stresses are in m, N and Pa in the file\n");
  print_text("\nwhere it comes from\n");
  for (const auto& [key, value] : lines_of(body.provenance)) print_text("  {:<18}{}\n", key, value);
}

void inspect(const InspectOptions& options) {
  const auto [body, touch, modal] = value_or_throw(read_body_and_touch(options.body));
  if (options.json) {
    Json result = json_of(body);
    if (modal) {
      result["touch"] = touch_json(*modal, body);
    } else {
      result["touch"] = touch ? touch_json(touch.value()) : Json(touch.problem().message);
    }
    print_json(result);
  } else {
    print_facts(body, modal ? touch_text(*modal, body) : touch_text(touch), options.body);
  }
}

}  // namespace

void add_inspect(Command app) {
  auto options = std::make_shared<InspectOptions>();
  Command command = app.add_subcommand("inspect", "Show what is in a body file");
  command.add_option("body", options->body, "Body file, or the name of an installed one (post)")
      .required();
  command.add_json(options->json);
  command.footer("Example: palpable inspect bunny.palpable");
  command.callback([options] {
    options->body = find_body(options->body);
    inspect(*options);
  });
}

}  // namespace palpable::app

// palpable inspect: prints the content of a body file.

#include "apps/common/command_line.h"
#include "apps/common/printing.h"
#include "apps/palpable/commands.h"
#include "apps/palpable/installed.h"
#include "palpable/common/base/error.h"
#include "palpable/common/body_file/body_facts.h"
#include "palpable/common/body_file/body_summary.h"
#include "palpable/common/body_file/touch_file.h"
#include "palpable/common/body_file/touch_text.h"
#include "palpable/common/reduced/evaluation_times.h"
#include "palpable/common/web_file/web_file.h"

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace palpable::app {
namespace {

struct InspectOptions {
  std::filesystem::path body;
  bool json = false;
};

// The time of one evaluation of displacement and stress of the skin, ms.
double evaluation_time(const ReducedBody& body) {
  constexpr int kRepeats = 40;  // some 0.1 s for a large body
  return 1e-3 * evaluation_times(body, kRepeats).all_us;
}

void print_lines(const std::string& heading,
                 const std::vector<std::pair<std::string, std::string>>& lines) {
  print_text("\n{}\n", heading);
  for (const auto& [name, text] : lines) print_text("  {:<20}{}\n", name, text);
}

void print_body(const BodyAndTouch& content, const std::filesystem::path& path) {
  const ReducedBody& body = content.body;
  print_text("{}", body_summary(content, evaluation_time(body), std::filesystem::file_size(path)));
  for (const FactGroup& group : body_facts(body, path, "--set")) {
    print_lines(group.heading, group.lines);
  }
  const std::string touch =
      content.modal ? touch_text(*content.modal, body) : touch_text(content.touch);
  const bool has_tables = content.touch.ok() && content.touch.value();
  const std::string inertia =
      vibration_text(has_tables ? content.touch.value()->vibration : std::nullopt);
  print_lines("touches live", {{"touch", touch}, {"inertia", inertia}});
  std::vector<std::pair<std::string, std::string>> provenance = lines_of(body.provenance);
  for (auto& [key, value] : provenance) value = with_larger_pascals(value);
  print_lines("where it comes from", provenance);
}

Json inspected_json(const BodyAndTouch& content, const std::filesystem::path& path) {
  const auto& [body, touch, modal] = content;
  Json result = json_of(body);
  result["file_bytes"] = std::filesystem::file_size(path);
  result["evaluation_ms"] = evaluation_time(body);
  if (modal) {
    result["touch"] = touch_json(*modal, body);
  } else {
    result["touch"] = touch.ok() ? touch_json(touch.value()) : Json(touch.problem().message);
  }
  return result;
}

// A body file's content, or that of a delivery file.
BodyAndTouch read_content(const std::filesystem::path& path) {
  if (path.extension() != kWebFileEnding) return value_or_throw(read_body_and_touch(path));
  TouchableBody read = value_or_throw(load_web_file(path));
  return {std::move(read.body), std::move(read.touch), std::move(read.modal)};
}

void inspect(const InspectOptions& options) {
  const BodyAndTouch content = read_content(options.body);
  if (options.json) {
    print_json(inspected_json(content, options.body));
  } else {
    print_body(content, options.body);
  }
}

}  // namespace

void add_inspect(Command app) {
  auto options = std::make_shared<InspectOptions>();
  Command command = app.add_subcommand("inspect", "Show what is in a body file");
  command
      .add_option("body", options->body,
                  "Body file, the name of an installed one (post), or a delivery file (.palpweb)")
      .type_name("FILE")
      .required();
  command.add_json(options->json);
  command.footer(
      "The first three lines say what the body is, how good its answers are and how fast they "
      "come. Lengths, loads and stresses are in m, N and Pa in the file.\n"
      "Example: palpable inspect bunny.palpable");
  command.callback([options] {
    options->body = find_body(options->body);
    inspect(*options);
  });
}

}  // namespace palpable::app

// palpable export bunny.palpable --to web -o bunny.palpweb
// palpable export bunny.palpable --to page -o bunny-page
//
// The other formats are written by palpable-bake, to which main.cpp passes them.

#include "apps/common/command_line.h"
#include "apps/common/export_options.h"
#include "apps/common/printing.h"
#include "apps/palpable/commands.h"
#include "apps/palpable/installed.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/file_format.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/base/output_name.h"
#include "palpable/common/base/text_numbers.h"
#include "palpable/common/body_file/touch_file.h"
#include "palpable/common/web_file/web_file.h"
#include "palpable/live/page/press_page.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace palpable::app {
namespace {

constexpr std::string_view kPage = "page";

struct WebOptions {
  std::vector<std::string> bodies;
  std::filesystem::path output;
  std::string to;
  std::string holds_all = "auto";
  std::vector<std::string> set;
};

TouchableBody read_body(const std::filesystem::path& path, const WebOptions& options) {
  return value_or_throw(read_pressable_touchable_body(path, parse_settings(options.set)));
}

void export_to_web(const std::vector<std::filesystem::path>& bodies, const WebOptions& options) {
  if (bodies.size() != 1) {
    throw Error(fmt::format("--to web writes one body, and there are {}; --to page takes several",
                            bodies.size()));
  }
  guard_output_file(options.output, {bodies[0]});
  require_ending(options.output, {kWebFileEnding}, "a delivery file");
  guard_format(options.output, FileFormat::kWebFile);
  write_web_file(options.output, read_body(bodies[0], options));
  print_text("{}\n", options.output.string());
}

void export_to_page(const std::vector<std::filesystem::path>& paths, const WebOptions& options) {
  require_folder_name(options.output);
  guard_output_folder(options.output, paths);
  const PageBundle bundle = read_page_bundle(shipped_page());
  std::vector<PageBody> bodies;
  std::size_t bytes = 0;
  for (const std::filesystem::path& path : paths) {
    bodies.push_back(page_body(read_body(path, options)));
    bytes += bodies.back().bytes.size();
  }
  name_files_apart(bodies);
  const bool holds_all =
      options.holds_all == "always" || (options.holds_all == "auto" && bytes <= kMostInline);
  write_page(options.output, bundle, bodies, holds_all);
  const std::string page = (options.output / "index.html").string();
  print_text("{}\n", page);
  if (holds_all) {
    print_text("one file with everything in it: open it in a browser, or send it\n");
  } else {
    print_text("a browser fetches its {:.0f} MB from a server: palpable serve {}\n",
               1e-6 * static_cast<double>(bytes), options.output.string());
  }
}

}  // namespace

bool asks_for_web(std::span<char* const> words) {
  const auto is_ours = [](std::string_view word) { return word == "web" || word == kPage; };
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string_view word = words[i];
    if (word.starts_with("--to=") && is_ours(word.substr(5))) return true;
    if (word == "--to" && i + 1 < words.size() && is_ours(words[i + 1])) return true;
  }
  return false;
}

void add_export(Command app) {
  const auto options = std::make_shared<WebOptions>();
  Command command =
      app.add_subcommand("export", "Write a body or its snapshots for other programs");
  command
      .add_option("input", options->bodies,
                  "A body file, or the name of an installed one (post); --to page: one or several")
      .required()
      .type_name("FILE");
  command
      .add_option(
          "--to", options->to,
          "web: one file that a page fetches. page: a page in which the bodies are pressed. "
          "The other formats are those of palpable-bake")
      .required()
      .one_of({"web", std::string(kPage)});
  command
      .add_option("-o,--out", options->output, "File to write, NAME.palpweb, or the page's folder")
      .required()
      .type_name("FILE|DIR");
  add_inline_option(command, options->holds_all);
  add_set_option(command, options->set);
  command.footer(
      "docs/body_file.md describes the file, docs/web.md the page.\n"
      "Example: palpable export bunny.palpable --to web -o bunny.palpweb\n"
      "Example: palpable export bunny.palpable --to page -o bunny-page");
  command.callback([options] {
    std::vector<std::filesystem::path> paths;
    for (const std::string& body : options->bodies) paths.push_back(find_body(body));
    if (options->to == kPage) {
      export_to_page(paths, *options);
    } else {
      export_to_web(paths, *options);
    }
  });
}

}  // namespace palpable::app

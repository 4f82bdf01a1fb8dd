// palpable report bunny.palpable: a page and a table of a body's errors, cost and content.

#include "apps/common/command_line.h"
#include "apps/common/printing.h"
#include "apps/palpable-bake/commands.h"
#include "palpable/bake/exchange/body_page.h"
#include "palpable/bake/exchange/web_page.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/base/output_name.h"
#include "palpable/common/base/this_machine.h"
#include "palpable/common/body_file/body_facts.h"
#include "palpable/common/body_file/touch_file.h"
#include "palpable/common/body_file/touch_text.h"
#include "palpable/common/reduced/evaluation_times.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;

struct ReportOptions {
  std::string body, output;
  bool json = false;
};

void report(const ReportOptions& options) {
  const fs::path page = options.output.empty()
                            ? fs::path(options.body).filename().replace_extension(".html")
                            : fs::path(options.output);
  const fs::path table = table_beside(page);
  for (const fs::path& output : {page, table}) guard_output_file(output, {options.body});
  require_ending(page, {".html", ".htm"}, "an HTML page");
  const auto [body, touch, modal] = value_or_throw(read_body_and_touch(options.body));
  BodyPageFacts facts{.file = fs::path(options.body).filename().string(),
                      .file_bytes = fs::file_size(options.body),
                      .processor = processor_name(),
                      .date = date_today(),
                      .program = std::string("palpable ") + PALPABLE_VERSION,
                      .touch = modal ? touch_text(*modal, body) : touch_text(touch)};
  if (touch.ok() && touch.value()) facts.held_out = touch.value()->held_out;
  const EvaluationTimes times = evaluation_times(body);
  facts.displacement_us = times.displacement_us;
  facts.stress_us = times.stress_us;
  facts.all_us = times.all_us;
  facts.repeats = times.repeats;
  write_whole_file(page, body_page(body, facts, table.filename().string()));
  write_whole_file(table, body_table(body, facts));
  if (options.json) {
    Json result = json_of(body);
    result["page"] = page.string();
    result["table"] = table.string();
    result["displacement_us"] = times.displacement_us;
    result["stress_us"] = times.stress_us;
    result["all_us"] = times.all_us;
    print_json(result);
    return;
  }
  print_text("{}: {:.1f} MB, opens in any browser, loads nothing; the same numbers: {}\n",
             page.string(), static_cast<double>(fs::file_size(page)) / 1e6, table.string());
  if (!body.error.displacement_course) {
    print_text(
        "the body file does not say how errors fall with the number of modes; palpable reduce, "
        "run again on its snapshots, does\n");
  }
}

}  // namespace

void add_report(Command app) {
  const auto options = std::make_shared<ReportOptions>();
  Command command = app.add_subcommand(
      "report",
      "Write errors, costs and modes of a body file as one HTML page, and a CSV file beside it");
  command.add_option("body,--body", options->body, "Body file").required().type_name("FILE");
  command
      .add_option("-o,--out", options->output,
                  "Page to write, NAME.html; the numbers go to NAME.csv")
      .default_is("the body's name, in this folder");
  command.add_json(options->json);
  command.footer(
      "The evaluation times in it are measured while the page is written.\n"
      "Example: palpable report bunny.palpable -o bunny.html");
  command.callback([options] { report(*options); });
}

}  // namespace palpable::app

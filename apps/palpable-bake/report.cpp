// palpable report bunny.palpable: what a body gives up, costs and is made of, as a page and a
// table.

#include "apps/common/command_line.h"
#include "apps/palpable-bake/body_report.h"
#include "apps/palpable-bake/commands.h"
#include "apps/palpable-bake/machine.h"
#include "apps/palpable-bake/text_file.h"
#include "palpable/base/error.h"
#include "palpable/exchange/body_page.h"
#include "palpable/reduced/body_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string body, output;
};

/// Median microseconds of one call. @param call  number of the touch
double median_us(int repeats, const std::function<void(int)>& call) {
  std::vector<double> times;
  for (int i = -repeats / 8; i < repeats; ++i) {  // the first ones warm the caches
    const auto begin = std::chrono::steady_clock::now();
    call(i);
    const std::chrono::duration<double, std::micro> taken =
        std::chrono::steady_clock::now() - begin;
    if (i >= 0) times.push_back(taken.count());
  }
  std::nth_element(times.begin(), times.begin() + repeats / 2, times.end());
  return times[static_cast<std::size_t>(repeats / 2)];
}

// As a hand goes: 20 levels up at one site, then at the next.
void measure(const ReducedBody& unsettled, BodyPageFacts& facts) {
  const ReducedBody body = value_or_throw(settled(unsettled));
  std::vector<float> u(static_cast<std::size_t>(body.displacement.value_count()));
  std::vector<float> sigma(static_cast<std::size_t>(body.stress.value_count()));
  std::vector<float> vm(sigma.size() / 6);
  const auto S = static_cast<int>(body.sites.size());
  const auto at = [&](int i) {
    const int touch = i + 1000;  // the warming ones are numbered below 0
    return std::array{static_cast<double>(touch / 20 % S), 0.05 * (touch % 20) + 0.03};
  };
  facts.repeats = 400;
  facts.displacement_us =
      median_us(facts.repeats, [&](int i) { body.displacement.evaluate(at(i), u); });
  facts.stress_us = median_us(facts.repeats, [&](int i) { body.stress.evaluate(at(i), sigma); });
  facts.all_us = median_us(facts.repeats, [&](int i) {
    body.displacement.evaluate(at(i), u);
    body.stress.evaluate(at(i), sigma);
    von_mises(sigma, vm);
  });
}

void report(const Options& options) {
  const fs::path page = options.output.empty()
                            ? fs::path(options.body).filename().replace_extension(".html")
                            : fs::path(options.output);
  require_folder_of(page);
  const fs::path table = table_beside(page);
  const ReducedBody body = value_or_throw(read_body_file(options.body));
  BodyPageFacts facts{.file = fs::path(options.body).filename().string(),
                      .file_bytes = fs::file_size(options.body),
                      .processor = processor_name(),
                      .date = date_today(),
                      .program = std::string("palpable ") + PALPABLE_VERSION};
  measure(body, facts);
  write_text_file(page, body_page(body, facts, table.filename().string()));
  write_text_file(table, body_table(body, facts));
  fmt::print("{}: {:.1f} MB, opens in any browser, loads nothing; the same numbers: {}\n",
             page.string(), static_cast<double>(fs::file_size(page)) / 1e6, table.string());
  if (!body.error.displacement_course) {
    fmt::print(
        "the body file does not say how errors fall with the number of modes; palpable reduce, "
        "run again on its snapshots, does\n");
  }
}

}  // namespace

void add_report(Command app) {
  const auto options = std::make_shared<Options>();
  Command command = app.add_subcommand(
      "report", "Errors, costs and modes of a body file: one HTML page, and a CSV file beside it");
  command.add_option("body", options->body, "Body file").required().type_name("BODY.palpable");
  command
      .add_option("-o,--out", options->output,
                  "Page to write, NAME.html; the numbers go to NAME.csv; else the body's name, "
                  "in this folder")
      .type_name("FILE");
  command.footer(
      "Evaluation times in it are measured as the page is written.\n"
      "Example: palpable report bunny.palpable -o bunny.html");
  command.callback([options] { report(*options); });
}

}  // namespace palpable::app

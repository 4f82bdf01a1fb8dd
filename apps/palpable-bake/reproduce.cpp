// palpable reproduce all -o DIR: the paper's three examples, figure by figure, as one page.

#include "apps/common/command_line.h"
#include "apps/common/printing.h"
#include "apps/palpable-bake/commands.h"
#include "palpable/bake/reproduce/chart.h"
#include "palpable/bake/reproduce/paper_figures.h"
#include "palpable/bake/reproduce/paper_numbers.h"
#include "palpable/bake/reproduce/paper_page.h"
#include "palpable/bake/reproduce/paper_plan.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/folder_lock.h"
#include "palpable/common/base/json.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/base/output_name.h"
#include "palpable/common/base/progress.h"
#include "palpable/common/base/this_machine.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;

struct ReproduceOptions {
  std::string what;
  fs::path out;
  bool touch = false;
  bool json = false;
};

// The project's folder: the current folder or one above it, or one above the program.
fs::path project_root() {
  for (const fs::path& from : {fs::current_path(), folder_of_program()}) {
    for (fs::path folder = from; folder != folder.root_path(); folder = folder.parent_path()) {
      if (fs::exists(folder / "bodies" / "dragon.toml") &&
          fs::exists(folder / "scenes" / "crossed-beams.toml")) {
        return folder;
      }
    }
  }
  throw Error("reproduce reads bodies/ and scenes/ of the project: run it in the project's folder");
}

std::vector<PaperExample> examples_of(const std::string& what) {
  if (what == "beams") return {PaperExample::kBeams};
  if (what == "bunny") return {PaperExample::kBunny};
  if (what == "dragon") return {PaperExample::kDragon};
  return {PaperExample::kBeams, PaperExample::kBunny, PaperExample::kDragon};
}

// A section for docs/results/ (tools/write_results.py), with the keys of --json.
Json result_of(const std::string& what, const std::vector<PaperFigure>& figures,
               const std::vector<PaperNumber>& numbers, const StepTimes& times) {
  Json result{{"title", "The paper's examples, side by side"},
              {"order", 5},
              {"text",
               "What the paper prints beside what `palpable reproduce` measured; the figures "
               "themselves are on the page that it writes."},
              {"command", fmt::format("palpable reproduce {} -o out/paper --json", what)},
              {"date", date_today()},
              {"machine", processor_name()},
              {"figures", Json::array()},
              {"bake_s", times.bakes},
              {"page_s", times.others},
              {"columns", Json::array({"", "paper", "Palpable", "remark"})},
              {"rows", Json::array()}};
  for (const PaperFigure& figure : figures) result["figures"].push_back(figure.number);
  for (const PaperNumber& number : numbers) {
    result["rows"].push_back(Json::array({number.what, number.paper, number.here, number.remark}));
  }
  return result;
}

void reproduce(const ReproduceOptions& options) {
  expect_gnuplot();
  const fs::path root = project_root();
  require_folder_name(options.out);
  make_folder(options.out);
  const fs::path out = fs::canonical(options.out);
  const FolderLock lock(out);
  const PaperPlan plan({.root = root,
                        .out = out,
                        .program = folder_of_program() / "palpable",
                        .touch = options.touch},
                       examples_of(options.what));
  plan.write_inputs();
  StepList list(out);
  list.run(plan.steps(), [](const std::string& line) { fmt::print(stderr, "{}\n", line); });

  const std::vector<PaperFigure> figures = make_figures(plan);
  const std::vector<PaperNumber> numbers = paper_numbers(plan, list);
  const StepTimes times = list.times(plan.steps());
  const fs::path page = out / "index.html";
  write_whole_file(
      page,
      paper_page({.numbers = numbers,
                  .figures = figures,
                  .provenance = {{"date", date_today()},
                                 {"machine", processor_name()},
                                 {"program", std::string("palpable ") + PALPABLE_VERSION},
                                 {"baked in", duration_text(times.bakes)},
                                 {"filmed, played and drawn in", duration_text(times.others)}}}));
  const Json result = result_of(options.what, figures, numbers, times);
  write_whole_file(out / "reproduce.json", result.dump(2) + "\n");
  if (options.json) {
    print_json(result);
    return;
  }
  print_text("{} figures, baked in {}, filmed, played and drawn in {}: {}\n", figures.size(),
             duration_text(times.bakes), duration_text(times.others), page.string());
}

}  // namespace

void add_reproduce(Command app) {
  const auto options = std::make_shared<ReproduceOptions>();
  Command command = app.add_subcommand(
      "reproduce", "The paper's examples and figures beside its own numbers, as a page");
  command.add_option("what", options->what, "Which of the paper's examples")
      .required()
      .one_of({"all", "beams", "bunny", "dragon"});
  command
      .add_option("-o,--out", options->out,
                  "Folder for bodies, films, runs, figures and the page, index.html")
      .required()
      .type_name("DIR");
  command.add_flag("--touch", options->touch,
                   "Bake the tables of touch, too, and show bodies that are touched anywhere; "
                   "some 40 minutes more");
  command.add_json(options->json);
  command.footer(
      "All three take a quarter of an hour on two idle cores from nothing, and 3 GB of disk. What "
      "is done stays done: a call that was stopped goes on where it was.\n"
      "Example: palpable reproduce all -o out/paper\n"
      "Example: palpable reproduce beams -o out/paper --json");
  command.callback([options] { reproduce(*options); });
}

}  // namespace palpable::app

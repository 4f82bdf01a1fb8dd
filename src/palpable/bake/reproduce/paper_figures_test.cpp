#include "palpable/bake/reproduce/paper_figures.h"

#include "palpable/bake/exchange/body_page.h"
#include "palpable/bake/reproduce/chart.h"
#include "palpable/bake/reproduce/paper_page.h"
#include "palpable/bake/reproduce/report_table.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/output_file.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <algorithm>
#include <cmath>
#include <fcntl.h>
#include <fstream>
#include <iostream>
#include <iterator>
#include <string>
#include <unistd.h>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;

const std::vector<PaperExample> kAll{PaperExample::kBeams, PaperExample::kBunny,
                                     PaperExample::kDragon};

void write(const fs::path& file, const std::string& text) {
  fs::create_directories(file.parent_path());
  std::ofstream(file) << text;
}

std::string bytes_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// What `palpable report` writes: errors that fall with the modes, two functions.
std::string small_report() {
  std::string text = fmt::format("{}\n", kBodyTableHeader);
  for (const char* field : {"displacement", "stress"}) {
    text += std::string("error_all_together,") + field + ",,,,,0.001,1\n";  // the body's own
    for (const char* quantity : {"error_all_together", "error_median", "error_worst"}) {
      for (const char* row : {",1,,,,0.1,1\n", ",2,,,,0.01,1\n"}) {
        text += std::string(quantity) + "," + field + row;
      }
    }
    text += std::string("function_of_site,") + field + ",1,0,,,0.5,1\n";
    text += std::string("function_of_site,") + field + ",1,1,,,-0.25,1\n";
    text += std::string("function_of_level,") + field + ",1,,0,,0,1\n";
    text += std::string("function_of_level,") + field + ",1,,0.5,,1.5,1\n";
  }
  return text;
}

// Writes everything that figures need from the steps' commands; each picture holds its own name.
void pretend_to_have_run(const fs::path& out) {
  for (const char* body : {"beam", "bunny", "dragon"}) {
    write(out / "reports" / (std::string(body) + ".csv"), small_report());
    write(out / "pictures" / (std::string(body) + "-modes") / "modes.png", body);
    write(out / "pictures" / (std::string(body) + "-stress-modes") / "modes.png", body);
  }
  for (const char* body : {"bunny", "dragon"}) {
    for (const char* name :
         {"2_sites.png", "3_press_site_7_level_33.png", "5_press_site_7_level_100.png"}) {
      write(out / "pictures" / (std::string(body) + "-sites") / name, name);
    }
  }
  for (const char* run :
       {"beams-live", "beams-paper", "room-live", "bunny-live", "bunny-paper", "bunny-hard",
        "bunny-depth", "bunny-surface", "dragon-live", "dragon-paper"}) {
    for (const char* frame : {"000060", "000118", "000150", "000098", "000142", "000174", "000215",
                              "000248", "000338", "000449"}) {
      write(out / "runs" / run / "pictures" / (std::string(frame) + ".png"),
            std::string(run) + frame);
    }
    write(out / "runs" / run / "trajectory.txt", "0 0 0 0 0 0 0 1\n");
  }
}

PaperPlan plan_in(const fs::path& out, const std::vector<PaperExample>& examples = kAll) {
  return PaperPlan({.root = fs::current_path(), .out = out, .program = "/bin/palpable"}, examples);
}

TEST_CASE("every figure of the paper that can be computed is made, in its order", "[reproduce]") {
  const test::ScratchFolder folder("paper_figures");
  pretend_to_have_run(folder.path());
  const std::vector<PaperFigure> figures = make_figures(plan_in(folder.path()));
  std::vector<std::string> numbers;
  for (const PaperFigure& figure : figures) {
    numbers.push_back(figure.number);
    INFO(figure.number);
    CHECK_FALSE(figure.pictures.empty());
    CHECK_FALSE(figure.commands.empty());
    for (const FigurePicture& picture : figure.pictures) {
      CHECK(fs::file_size(folder.path() / picture.file) > 0);
    }
    for (const fs::path& table : figure.tables) CHECK(fs::exists(folder.path() / table));
  }
  CHECK(numbers == std::vector<std::string>{"2c", "6", "7", "8", "9", "10", "11", "12", "13", "14",
                                            "15", "16", "17", "18", "19"});
  // Each frame comes from the run that its caption names.
  CHECK(bytes_of(folder / "figures" / "9_4.png") == "bunny-hard000174");
  CHECK(bytes_of(folder / "figures" / "12_3.png") == "beams-paper000150");

  const std::string page = paper_page({.numbers = {{"hardware", "a", "b", "c"}},
                                       .figures = figures,
                                       .provenance = {{"date", "2026-11-27"}}});
  CHECK(page.find("figures/18_1.png") != std::string::npos);
  CHECK(page.find("2026-11-27") != std::string::npos);
}

TEST_CASE("a picture that is missing is said by its name and its figure", "[reproduce]") {
  const test::ScratchFolder folder("paper_figures_missing");
  pretend_to_have_run(folder.path());
  fs::remove(folder / "runs" / "beams-live" / "pictures" / "000118.png");
  CHECK_THROWS_WITH(make_figures(plan_in(folder.path(), {PaperExample::kBeams})),
                    Catch::Contains("000118.png") && Catch::Contains("Figure 12"));
}

TEST_CASE("the scene of the beams holds the beam that was baked", "[reproduce]") {
  const test::ScratchFolder folder("paper_plan_scene");
  const PaperPlan plan = plan_in(folder.path(), {PaperExample::kBeams});
  plan.write_inputs();
  const std::string scene = bytes_of(folder / "scenes" / "crossed-beams.toml");
  CHECK(scene.find("file = \"../bodies/beam.palpable\"") != std::string::npos);
  CHECK(scene.find((fs::current_path() / "bodies" / "beam.toml").string()) != std::string::npos);
  CHECK(plan.step("beams/bake").product == folder / "bodies" / "beam.palpable");
}

TEST_CASE("every file that a step reads is made by an earlier step", "[reproduce]") {
  const test::ScratchFolder folder("paper_plan_order");
  const std::string out = folder.path().string();
  std::string made;
  for (const Step& step : plan_in(folder.path()).steps()) {
    CHECK(step.command({}).find('{') == std::string::npos);
    for (std::size_t i = 1; i < step.words.size(); ++i) {
      const std::string& word = step.words[i];
      const bool writes = step.words[i - 1] == "-o" || step.words[i - 1] == "--out";
      const bool own_text = word.find("/scenes/") != std::string::npos;
      if (writes || own_text || word.rfind(out, 0) != 0) continue;
      // A bake leaves its snapshots beside its body, a film its frames.
      fs::path stem = word;
      if (stem.filename() == "frames") stem = stem.parent_path();
      if (stem.extension() == ".snapshots") stem.replace_extension(".palpable");
      INFO(step.what << " reads " << word);
      CHECK(made.find('\n' + stem.string() + '\n') != std::string::npos);
    }
    for (std::size_t i = 1; i < step.words.size(); ++i) {
      if (step.words[i - 1] == "-o" || step.words[i - 1] == "--out") {
        made += '\n' + step.words[i] + '\n';
      }
    }
  }
}

// The text that `work` writes to standard output and error.
template <class Work>
std::string said_by(const fs::path& file, const Work& work) {
  std::cout.flush();
  std::cerr.flush();
  const int out = ::dup(STDOUT_FILENO), error = ::dup(STDERR_FILENO);
  const int to = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  ::dup2(to, STDOUT_FILENO);
  ::dup2(to, STDERR_FILENO);
  work();
  ::dup2(out, STDOUT_FILENO);
  ::dup2(error, STDERR_FILENO);
  for (const int used : {out, error, to}) ::close(used);
  return bytes_of(file);
}

TEST_CASE("charts of few points and of many are drawn without a word", "[reproduce]") {
  const test::ScratchFolder folder("chart");
  ChartLine few{"few", {1, 2, 3}, {0.1, 0.01, 0.02}}, many{"many \"lines\"", {}, {}};
  for (int k = 1; k < 200; ++k) {
    many.x.push_back(k);
    many.y.push_back(1.0 / k);
  }
  const fs::path png = folder / "a.png";
  CHECK(said_by(folder / "said.txt", [&] {
          draw_charts({{"a", "x", "y", true, {few, many}}, {"b", "x", "y", false, {many}}}, png);
        }).empty());
  CHECK(bytes_of(png).substr(1, 3) == "PNG");
}

TEST_CASE("the lines of a chart are read from a report's table", "[reproduce]") {
  const test::ScratchFolder folder("report_table");
  write(folder / "body.csv", small_report());
  const std::vector<ReportRow> table = read_report_table(folder / "body.csv");
  const ChartLine errors = over_modes(table, "error_all_together", "stress", "stress");
  CHECK(errors.x == std::vector<double>{1, 2});
  CHECK(errors.y == std::vector<double>{0.1, 0.01});
  CHECK(over_sites(table, "displacement", 1).y == std::vector<double>{0.5, -0.25});
  CHECK(over_levels(table, "displacement", 1).x == std::vector<double>{0, 0.5});
  CHECK(over_levels(table, "displacement", 2).x.empty());
  CHECK(chart_table({"t", "x", "y", true, {errors}}) == "line,x,y\nstress,1,0.1\nstress,2,0.01\n");
  write(folder / "other.csv", "a,b\n1,2\n");
  CHECK_THROWS_WITH(read_report_table(folder / "other.csv"),
                    Catch::Contains("other.csv") && Catch::Contains("no table"));
  CHECK_THROWS_AS(read_report_table(folder / "none.csv"), Error);
}

}  // namespace
}  // namespace palpable

#include "palpable/bake/reproduce/chart.h"

#include "palpable/bake/exchange/web_page.h"
#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/output_file.h"

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

namespace palpable {
namespace {

constexpr std::string_view kColors[] = {"#2563c9", "#d2601a", "#0f8a6a",
                                        "#8b47b8", "#b0892a", "#c2315a"};

// Text within "..." of a gnuplot script.
std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c;
  }
  return result + '"';
}

std::string script_of(const std::vector<Chart>& charts, const std::filesystem::path& png) {
  const int columns = static_cast<int>(charts.size());
  std::string script = fmt::format(
      "set terminal pngcairo noenhanced size {},{} font \"DejaVu Sans,11\"\n"
      "set output {}\nset multiplot layout 1,{}\nset grid lc rgb \"#d8dce1\"\n"
      "set border lc rgb \"#5c6670\"\nset key top right\n",
      columns == 1 ? 900 : 620 * columns, 520, quoted(png.string()), columns);
  for (const Chart& chart : charts) {
    script += fmt::format("set title {}\nset xlabel {}\nset ylabel {}\n{} logscale y\n",
                          quoted(chart.title), quoted(chart.x_label), quoted(chart.y_label),
                          chart.log_y ? "set" : "unset");
    script += chart.log_y ? "set format y \"%.0e\"\n" : "set format y \"%g\"\n";
    script += "plot ";
    for (std::size_t i = 0; i < chart.lines.size(); ++i) {
      const ChartLine& line = chart.lines[i];
      script +=
          fmt::format("{}\"-\" using 1:2 with {} lw 2 lc rgb \"{}\" title {}", i > 0 ? ", " : "",
                      line.x.size() <= 40 ? "linespoints pt 7 ps 0.5" : "lines",
                      kColors[i % std::size(kColors)], quoted(line.name));
    }
    script += "\n";
    for (const ChartLine& line : chart.lines) {
      for (std::size_t k = 0; k < line.x.size(); ++k) {
        script += fmt::format("{:.9g} {:.9g}\n", line.x[k], line.y[k]);
      }
      script += "e\n";
    }
  }
  return script + "unset multiplot\n";
}

}  // namespace

std::string chart_table(const Chart& chart) {
  std::string table = "line,x,y\n";
  for (const ChartLine& line : chart.lines) {
    for (std::size_t k = 0; k < line.x.size(); ++k) {
      table += fmt::format("{},{:.9g},{:.9g}\n", csv_cell(line.name), line.x[k], line.y[k]);
    }
  }
  return table;
}

void expect_gnuplot() {
  if (std::system("gnuplot --version >/dev/null 2>&1") == 0) return;
  throw Error("charts are drawn by gnuplot, which is not here: apt-get install gnuplot-nox");
}

void draw_charts(const std::vector<Chart>& charts, const std::filesystem::path& png) {
  PALPABLE_EXPECT(!charts.empty(), "a picture of at least one chart");
  for (const Chart& chart : charts) {
    PALPABLE_EXPECT(!chart.lines.empty(), "a chart has lines");
    for (const ChartLine& line : chart.lines) {
      PALPABLE_EXPECT(line.x.size() == line.y.size(), "each x has its y");
    }
  }
  expect_writable(png);
  // gnuplot's error messages go to the terminal.
  std::FILE* gnuplot = ::popen("gnuplot >/dev/null", "w");
  if (gnuplot == nullptr) expect_gnuplot();
  const std::string script = script_of(charts, png);
  const bool sent = std::fwrite(script.data(), 1, script.size(), gnuplot) == script.size();
  const int status = ::pclose(gnuplot);
  if (!sent || status != 0 || !std::filesystem::exists(png)) {
    throw Error(fmt::format("{}: gnuplot could not draw it", png.string()));
  }
}

}  // namespace palpable

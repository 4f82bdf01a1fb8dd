/// @file
/// Line charts: as a CSV table, and as a picture that gnuplot draws.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace palpable {

struct ChartLine {
  std::string name;
  std::vector<double> x, y;  ///< of the same length
};

struct Chart {
  std::string title, x_label, y_label;
  bool log_y = false;
  std::vector<ChartLine> lines;
};

/// CSV: the header "line,x,y" and a row for each point.
[[nodiscard]] std::string chart_table(const Chart& chart);

/// Draws charts beside each other in one picture, PNG.
/// @throws Error when gnuplot is not there or cannot draw them, or the file cannot be written
void draw_charts(const std::vector<Chart>& charts, const std::filesystem::path& png);

/// Checks that gnuplot is installed, which draw_charts() needs.
/// @throws Error that says what to install if it is not
void expect_gnuplot();

}  // namespace palpable

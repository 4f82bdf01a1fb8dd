/// @file
/// Lines over numbers: as a table for programs and, drawn by gnuplot, as a picture.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace palpable {

struct ChartLine {
  std::string name;
  std::vector<double> x, y;  ///< as many of both
};

struct Chart {
  std::string title, x_label, y_label;
  bool log_y = false;
  std::vector<ChartLine> lines;
};

/// "line,x,y" and a row for each point.
[[nodiscard]] std::string chart_table(const Chart& chart);

/// Charts beside each other in one picture, PNG.
/// @throws Error when gnuplot is not there or cannot draw them, or the file cannot be written
void draw_charts(const std::vector<Chart>& charts, const std::filesystem::path& png);

/// Whether draw_charts() can do anything. @throws Error that says what to install
void expect_gnuplot();

}  // namespace palpable

#include "palpable/bake/reproduce/report_table.h"

#include "palpable/bake/exchange/body_page.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/whole_file.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <string_view>

namespace palpable {
namespace {

constexpr std::size_t kCells = 8;

double number_of(std::string_view cell) {
  double number = std::numeric_limits<double>::quiet_NaN();
  std::from_chars(cell.data(), cell.data() + cell.size(), number);
  return number;
}

ChartLine line_of(const std::vector<ReportRow>& table, const std::string& quantity,
                  const std::string& field, int mode, double ReportRow::*over) {
  ChartLine line{fmt::format("{}", mode), {}, {}};
  for (const ReportRow& row : table) {
    if (row.quantity != quantity || row.field != field || row.modes != mode) continue;
    line.x.push_back(row.*over);
    line.y.push_back(row.value);
  }
  return line;
}

constexpr std::uintmax_t kLargestTable = 64'000'000;  // bytes; a report's table has thousands

}  // namespace

std::vector<ReportRow> read_report_table(const std::filesystem::path& csv) {
  const Result<std::string> text = read_text_file(csv, {.most = kLargestTable});
  if (!text.ok()) throw Error(fmt::format("{}: {}", csv.string(), text.problem().message));
  std::vector<ReportRow> rows;
  std::string_view rest = text.value();
  for (std::size_t number = 0; !rest.empty(); ++number) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (number == 0) {
      if (line != kBodyTableHeader) {
        throw Error(fmt::format("{}: line 1: is no table of palpable report", csv.string()));
      }
      continue;
    }
    std::array<std::string_view, kCells> cells{};
    std::string_view left = line;
    for (std::string_view& cell : cells) {
      const std::size_t comma = std::min(left.find(','), left.size());
      cell = left.substr(0, comma);
      left.remove_prefix(std::min(comma + 1, left.size()));
    }
    rows.push_back({std::string(cells[0]), std::string(cells[1]), number_of(cells[2]),
                    number_of(cells[3]), number_of(cells[4]), number_of(cells[6])});
  }
  return rows;
}

ChartLine over_modes(const std::vector<ReportRow>& table, const std::string& quantity,
                     const std::string& field, const std::string& name) {
  ChartLine line{name, {}, {}};
  for (const ReportRow& row : table) {
    if (row.quantity != quantity || row.field != field || std::isnan(row.modes)) continue;
    line.x.push_back(row.modes);
    line.y.push_back(row.value);
  }
  return line;
}

ChartLine over_levels(const std::vector<ReportRow>& table, const std::string& field, int mode) {
  return line_of(table, "function_of_level", field, mode, &ReportRow::level);
}

ChartLine over_sites(const std::vector<ReportRow>& table, const std::string& field, int mode) {
  return line_of(table, "function_of_site", field, mode, &ReportRow::site);
}

}  // namespace palpable

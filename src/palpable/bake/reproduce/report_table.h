/// @file
/// Reads the table that `palpable report` writes beside its page.
#pragma once

#include "palpable/bake/reproduce/chart.h"

#include <filesystem>
#include <string>
#include <vector>

namespace palpable {

/// A row of body_table() (exchange/body_page.h). Empty cells are NaN.
struct ReportRow {
  std::string quantity, field;
  double modes = 0, site = 0, level = 0, value = 0;
};

/// @throws Error when the file cannot be read or is no such table
[[nodiscard]] std::vector<ReportRow> read_report_table(const std::filesystem::path& csv);

/// Values of a quantity against the number of modes, in the table's order. Rows without a number of
/// modes, which are of the whole body, are left out.
[[nodiscard]] ChartLine over_modes(const std::vector<ReportRow>& table, const std::string& quantity,
                                   const std::string& field, const std::string& name);

/// Function `mode` (from 1) against the level of the load: (0, 0), ..., (1, .).
[[nodiscard]] ChartLine over_levels(const std::vector<ReportRow>& table, const std::string& field,
                                    int mode);

/// Function `mode` against the number of the load's site.
[[nodiscard]] ChartLine over_sites(const std::vector<ReportRow>& table, const std::string& field,
                                   int mode);

}  // namespace palpable

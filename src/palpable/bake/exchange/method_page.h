/// @file
/// A page that compares methods of reduction and body files: error against modes and bytes.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpable {

/// One line of the chart: the error of a method as its number of modes grows. All lists have one
/// length, except those that are empty.
struct MethodLine {
  std::string name;                ///< e.g. "pgd, 3 factors"
  bool is_body = false;            ///< it is a body file, and not a method applied to snapshots
  std::vector<int> modes = {};     ///< per-site: modes of each site; hosvd: functions of space
  std::vector<int> columns = {};   ///< modes of all sites together
  std::vector<double> bytes = {};  ///< of modes (boundary, single precision) and functions
  std::vector<double> pooled = {}, median = {}, worst = {};
  std::vector<int> ranks = {};         ///< hosvd
  std::optional<double> seconds = {};  ///< wall time of the method, from the Gram matrix on
};

/// Content of the page. Texts are plain; displacement and stress have a chart each.
struct MethodPage {
  std::string title;
  std::string lead;
  std::vector<MethodLine> displacement, stress;
  std::vector<std::pair<std::string, std::string>> provenance;
  std::string footer;
};

/// The page as one HTML file that loads nothing.
[[nodiscard]] std::string method_page(const MethodPage& page);

/// The same numbers as CSV, one line for each method and number of modes.
[[nodiscard]] std::string method_table(const MethodPage& page);

/// Where each method ended, for a terminal: a table for displacement and one for stress.
[[nodiscard]] std::string method_text(const MethodPage& page);

}  // namespace palpable

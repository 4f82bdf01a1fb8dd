/// @file
/// Methods of reduction and body files on one chart: error against modes and bytes.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpable {

/// One line of the chart: a method stopped after more and more modes. All lists of one length.
struct MethodLine {
  std::string name;                ///< e.g. "pgd, 3 factors"
  bool is_body = false;            ///< from a body file, not from snapshots
  std::vector<int> modes = {};     ///< per-site: of each site; hosvd: functions of space
  std::vector<int> columns = {};   ///< of all blocks
  std::vector<double> bytes = {};  ///< of modes (boundary, single precision) and functions
  std::vector<double> pooled = {}, median = {}, worst = {};
  std::vector<int> ranks = {};         ///< hosvd
  std::optional<double> seconds = {};  ///< that the method took
};

struct MethodPage {
  std::string title;
  std::string lead;
  std::vector<MethodLine> displacement, stress;
  std::vector<std::pair<std::string, std::string>> provenance;
  std::string footer;
};

/// One HTML file that loads nothing.
[[nodiscard]] std::string method_page(const MethodPage& page);

/// The same numbers, one step of one method a line.
[[nodiscard]] std::string method_table(const MethodPage& page);

}  // namespace palpable

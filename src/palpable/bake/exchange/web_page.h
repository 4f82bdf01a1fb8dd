/// @file
/// A web page in one file. It loads nothing else, so it can be opened offline, from a mail or from
/// an archive. The chart library (uPlot, MIT), styles and scripts are compiled into the program.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace palpable {

/// A file of src/palpable/bake/exchange/pages or of the chart library.
struct PageFile {
  std::string_view name;     ///< e.g. "page.css"
  std::string_view content;  ///< UTF-8
};

/// Content of a page.
struct WebPage {
  std::string title;                 ///< plain text
  std::string content;               ///< name of an HTML part, e.g. "body.html"
  std::vector<std::string> scripts;  ///< names of scripts after common.js, in order
  /// (key, plain text) that replaces {{key}} in the HTML part; "title" is always replaced.
  std::vector<std::pair<std::string, std::string>> texts;
  std::string data;  ///< JSON; the scripts read it as DATA
};

/// The whole file as text.
/// @throws ContractViolation if a part, or the text for a {{key}}, is missing
[[nodiscard]] std::string web_page(const WebPage& page);

/// The path of the table of a page's numbers: "report.html" has "report.csv" beside it. The user
/// does not name that file, so an existing one is replaced only if it is such a table.
/// @throws Error if the page is called .csv itself, and for an existing .csv that is not such a
///         table
[[nodiscard]] std::filesystem::path table_beside(const std::filesystem::path& page);

/// A cell of a CSV file (RFC 4180), quoted if it holds a comma, a quote or a line end.
[[nodiscard]] std::string csv_cell(std::string_view text);

}  // namespace palpable

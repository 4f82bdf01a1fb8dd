/// @file
/// A web page in one file. It loads nothing, so that it opens from a folder, from a mail, and in
/// ten years; chart library (uPlot, MIT), styles and scripts are compiled into the program.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace palpable {

/// A part of a page as it lies in src/palpable/exchange/pages, or of the chart library.
struct PageFile {
  std::string_view name;     ///< e.g. "page.css"
  std::string_view content;  ///< UTF-8
};

/// What a page is made of.
struct WebPage {
  std::string title;                 ///< plain text
  std::string content;               ///< name of an HTML part, e.g. "body.html"
  std::vector<std::string> scripts;  ///< names of scripts after common.js, in order
  /// For {{key}} in the HTML part: plain text; "title" is there already.
  std::vector<std::pair<std::string, std::string>> texts;
  std::string data;  ///< JSON, what the scripts find as DATA
};

/// The whole file. @throws ContractViolation if a part or text is not there
[[nodiscard]] std::string web_page(const WebPage& page);

/// RFC 4648, with padding.
[[nodiscard]] std::string base64(std::string_view bytes);

/// A cell of a CSV file (RFC 4180): quoted where it must be.
[[nodiscard]] std::string csv_cell(std::string_view text);

}  // namespace palpable

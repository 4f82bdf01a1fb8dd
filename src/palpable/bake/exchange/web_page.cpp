#include "palpable/bake/exchange/web_page.h"

#include "palpable/common/base/contract.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/markup_text.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <span>
#include <system_error>

namespace palpable {

std::span<const PageFile> exchange_page_files();  // cmake/EmbedFiles.cmake

namespace {

std::string_view part(std::string_view name) {
  const std::span<const PageFile> files = exchange_page_files();
  const auto found = std::find_if(files.begin(), files.end(),
                                  [&](const PageFile& file) { return file.name == name; });
  PALPABLE_EXPECT(found != files.end(), "a part of a page that was compiled in");
  return found->content;
}

// Replaces every {{key}} of a text, from left to right. Inserted text is not searched again.
std::string filled(std::string_view text,
                   const std::vector<std::pair<std::string_view, std::string>>& values) {
  std::string result;
  while (true) {
    const std::size_t begin = text.find("{{");
    if (begin == std::string_view::npos) return result += text;
    const std::size_t end = text.find("}}", begin);
    PALPABLE_EXPECT(end != std::string_view::npos, "a place in a page ends");
    const std::string_view key = text.substr(begin + 2, end - begin - 2);
    const auto value = std::find_if(values.begin(), values.end(),
                                    [&](const auto& entry) { return entry.first == key; });
    PALPABLE_EXPECT(value != values.end(), "a text for each place in a page");
    result += text.substr(0, begin);
    result += value->second;
    text.remove_prefix(end + 2);
  }
}

// A script element ends at the first "</", even within a JSON string; "<\/" means the same there.
std::string inside_script(std::string_view json) {
  std::string safe;
  for (std::size_t i = 0; i < json.size(); ++i) {
    safe += json[i];
    if (json[i] == '<' && i + 1 < json.size() && (json[i + 1] == '/' || json[i + 1] == '!')) {
      safe.pop_back();
      safe += "\\u003c";
    }
  }
  return safe;
}

}  // namespace

std::string web_page(const WebPage& page) {
  std::vector<std::pair<std::string_view, std::string>> texts{{"title", markup_text(page.title)}};
  for (const auto& [key, text] : page.texts) texts.emplace_back(key, markup_text(text));
  std::string script = "/*!\nuPlot: ";
  script += part("LICENSE");  // required by its terms
  script += "*/\n";
  script += part("uPlot.iife.min.js");
  script += "\n";
  script += part("common.js");
  for (const std::string& name : page.scripts) script += part(name);
  std::string style(part("uPlot.min.css"));
  style += "\n";
  style += part("page.css");
  return filled(part("page.html"), {{"title", markup_text(page.title)},
                                    {"style", style},
                                    {"content", filled(part(page.content), texts)},
                                    {"data", inside_script(page.data)},
                                    {"script", script}});
}

std::filesystem::path table_beside(const std::filesystem::path& page) {
  std::filesystem::path table = page;
  table.replace_extension(".csv");
  if (table == page) {
    throw Error(fmt::format("{}: is where the table goes; call the page {}.html", page.string(),
                            page.stem().string()));
  }
  std::error_code error;
  if (!std::filesystem::is_regular_file(table, error)) return table;
  std::string start(40, '\0');
  std::ifstream in(table, std::ios::binary);
  in.read(start.data(), static_cast<std::streamsize>(start.size()));
  // The tables of `report` and `compare` begin like this (body_table(), method_table()).
  if (start.starts_with("quantity,field,modes,") || start.starts_with("field,method,source,")) {
    return table;
  }
  throw Error(
      fmt::format("{}: is somebody's, and where the numbers of the page go; give the page another "
                  "name",
                  table.string()));
}

std::string csv_cell(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string cell = "\"";
  for (const char c : text) {
    cell += c;
    if (c == '"') cell += c;
  }
  return cell + "\"";
}

}  // namespace palpable

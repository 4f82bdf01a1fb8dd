#include "palpable/bake/exchange/method_page.h"

#include "palpable/bake/exchange/web_page.h"
#include "palpable/common/base/json.h"

#include <fmt/format.h>

#include <cstddef>

namespace palpable {
namespace {

Json line_json(const MethodLine& line) {
  Json result{{"name", line.name},     {"source", line.is_body ? "body" : "method"},
              {"modes", line.modes},   {"columns", line.columns},
              {"bytes", line.bytes},   {"pooled", line.pooled},
              {"median", line.median}, {"worst", line.worst}};
  if (!line.ranks.empty()) result["ranks"] = line.ranks;
  if (line.seconds) result["seconds"] = *line.seconds;
  return result;
}

}  // namespace

std::string method_page(const MethodPage& page) {
  Json data;
  data["fields"] = Json::object();
  for (const auto& [name, lines] :
       {std::pair{"displacement", &page.displacement}, std::pair{"stress", &page.stress}}) {
    if (lines->empty()) continue;
    Json all = Json::array();
    for (const MethodLine& line : *lines) all.push_back(line_json(line));
    data["fields"][name] = std::move(all);
  }
  data["provenance"] = Json::array();
  for (const auto& [key, value] : page.provenance) data["provenance"].push_back({key, value});
  return web_page({.title = page.title,
                   .content = "compare.html",
                   .scripts = {"compare.js"},
                   .texts = {{"lead", page.lead}, {"footer", page.footer}},
                   .data = data.dump()});
}

std::string method_table(const MethodPage& page) {
  std::string table =
      "field,method,source,modes,columns,bytes,error_all_together,error_median,error_worst\n";
  for (const auto& [name, lines] :
       {std::pair{"displacement", &page.displacement}, std::pair{"stress", &page.stress}}) {
    for (const MethodLine& line : *lines) {
      for (std::size_t i = 0; i < line.modes.size(); ++i) {
        table +=
            fmt::format("{},{},{},{},{},{:.0f},{:.9g},{:.9g},{:.9g}\n", name, csv_cell(line.name),
                        line.is_body ? "body" : "method", line.modes[i], line.columns[i],
                        line.bytes[i], line.pooled[i], line.median[i], line.worst[i]);
      }
    }
  }
  return table;
}

std::string method_text(const MethodPage& page) {
  std::string text;
  for (const auto& [name, lines] :
       {std::pair{"displacement", &page.displacement}, std::pair{"stress", &page.stress}}) {
    if (lines->empty()) continue;
    text += fmt::format("{}\n  {:<34} {:>6} {:>7} {:>10} {:>12} {:>9} {:>9}\n", name, "", "modes",
                        "in all", "MB", "all together", "median", "worst");
    for (const MethodLine& line : *lines) {
      text += fmt::format("  {:<34} {:>6} {:>7} {:>10.2f} {:>12.2g} {:>9.2g} {:>9.2g}\n", line.name,
                          line.modes.back(), line.columns.back(), line.bytes.back() / 1e6,
                          line.pooled.back(), line.median.back(), line.worst.back());
    }
  }
  return text;
}

}  // namespace palpable

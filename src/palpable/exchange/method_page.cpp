#include "palpable/exchange/method_page.h"

#include "palpable/exchange/web_page.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cstddef>

namespace palpable {
namespace {

using Json = nlohmann::ordered_json;

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
                   .data = data.dump(-1, ' ', false, Json::error_handler_t::replace)});
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

}  // namespace palpable

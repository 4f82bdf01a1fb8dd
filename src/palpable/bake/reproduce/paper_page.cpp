#include "palpable/bake/reproduce/paper_page.h"

#include "palpable/bake/exchange/web_page.h"
#include "palpable/common/base/json.h"

#include <filesystem>

namespace palpable {
namespace {

Json texts_of(const std::vector<std::filesystem::path>& files) {
  Json all = Json::array();
  for (const std::filesystem::path& file : files) all.push_back(file.generic_string());
  return all;
}

Json figure_json(const PaperFigure& figure) {
  Json pictures = Json::array();
  for (const FigurePicture& picture : figure.pictures) {
    pictures.push_back({{"file", picture.file.generic_string()}, {"caption", picture.caption}});
  }
  Json commands = Json::array();
  for (const std::string& command : figure.commands) commands.push_back(command);
  return {{"number", figure.number},
          {"title", figure.title},
          {"paper", figure.paper},
          {"differs", figure.differs},
          {"pictures", pictures},
          {"tables", texts_of(figure.tables)},
          {"films", texts_of(figure.films)},
          {"commands", commands}};
}

}  // namespace

std::string paper_page(const PaperPage& page) {
  Json data{{"numbers", Json::array()}, {"figures", Json::array()}, {"provenance", Json::array()}};
  for (const PaperNumber& number : page.numbers) {
    data["numbers"].push_back(Json::array({number.what, number.paper, number.here, number.remark}));
  }
  for (const PaperFigure& figure : page.figures) data["figures"].push_back(figure_json(figure));
  for (const auto& [key, value] : page.provenance) {
    data["provenance"].push_back(Json::array({key, value}));
  }
  return web_page(
      {.title = "The paper, reproduced",
       .content = "reproduce.html",
       .scripts = {"reproduce.js"},
       .texts =
           {{"lead",
             "Real-time interaction of virtual and physical objects in Mixed Reality "
             "applications (Badías, González, Alfaro, Chinesta, Cueto), figure by figure: what "
             "the paper shows and says, what Palpable makes of it on the synthetic desk, and "
             "the command for each."},
            {"measured",
             "Measured on the machine below by the run that wrote this page, and "
             "beside whatever else it did."},
            {"footer",
             "Made by palpable reproduce. Pictures, tables (CSV) and films lie "
             "beside this page and travel with its folder."}},
       .data = data.dump()});
}

}  // namespace palpable

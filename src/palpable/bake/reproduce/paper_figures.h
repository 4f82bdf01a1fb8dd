/// @file
/// The paper's figures, assembled from the results of a plan's commands: pictures, tables and the
/// texts beside them. paper.toml lists them.
#pragma once

#include "palpable/bake/reproduce/paper_plan.h"

#include <filesystem>
#include <string>
#include <vector>

namespace palpable {

struct FigurePicture {
  std::filesystem::path file;  ///< relative to the page's folder
  std::string caption;
};

struct PaperFigure {
  std::string number;  ///< of the paper: "2c", "9"
  std::string title = {};
  std::string paper = {};    ///< what the paper shows and says
  std::string differs = {};  ///< what differs here, and why
  std::vector<FigurePicture> pictures = {};
  std::vector<std::filesystem::path> tables = {};  ///< CSV, relative to the page's folder
  std::vector<std::filesystem::path> films = {};   ///< MP4
  std::vector<std::string> commands = {};          ///< that reproduce it, as a user types them
};

/// Copies and draws all figures of the plan's examples into OUT/figures, in the paper's order.
/// @pre all steps of the plan have been run
/// @throws Error when a result of the steps is missing or cannot be read
[[nodiscard]] std::vector<PaperFigure> make_figures(const PaperPlan& plan);

}  // namespace palpable

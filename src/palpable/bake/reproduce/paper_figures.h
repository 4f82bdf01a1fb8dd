/// @file
/// The paper's figures from what a plan's commands have made: pictures, tables, and what to say
/// beside them.
#pragma once

#include "palpable/bake/reproduce/paper_plan.h"

#include <filesystem>
#include <string>
#include <vector>

namespace palpable {

struct FigurePicture {
  std::filesystem::path file;  ///< from the page's folder
  std::string caption;
};

struct PaperFigure {
  std::string number;  ///< of the paper: "2c", "9"
  std::string title;
  std::string paper;    ///< what the paper shows there and says of it
  std::string differs;  ///< what differs here, and why
  std::vector<FigurePicture> pictures = {};
  std::vector<std::filesystem::path> tables = {};  ///< CSV, from the page's folder
  std::vector<std::filesystem::path> films = {};   ///< MP4
  std::vector<std::string> commands = {};          ///< that make it, as a user types them
};

/// Copies and draws all figures of the plan's examples into OUT/figures, in the paper's order.
/// All steps of the plan have been run.
/// @throws Error when something that the steps make is missing or cannot be read
[[nodiscard]] std::vector<PaperFigure> make_figures(const PaperPlan& plan);

}  // namespace palpable

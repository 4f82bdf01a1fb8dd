/// @file
/// One page with the paper's figures and numbers beside ours.
#pragma once

#include "palpable/bake/reproduce/paper_figures.h"
#include "palpable/bake/reproduce/paper_numbers.h"

#include <string>
#include <utility>
#include <vector>

namespace palpable {

struct PaperPage {
  std::vector<PaperNumber> numbers;
  std::vector<PaperFigure> figures;
  std::vector<std::pair<std::string, std::string>> provenance;  ///< (key, value) for people
};

/// The page as HTML; paths of pictures, tables and films are relative to its folder.
[[nodiscard]] std::string paper_page(const PaperPage& page);

}  // namespace palpable

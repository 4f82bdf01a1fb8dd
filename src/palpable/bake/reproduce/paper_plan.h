/// @file
/// The commands that reproduce the paper's three examples (Secs. 5.1 to 5.3): bakes, films, live
/// runs and pictures, each after those whose results it needs. paper.toml lists them.
#pragma once

#include "palpable/bake/reproduce/paper_data.h"
#include "palpable/bake/reproduce/step_list.h"

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace palpable {

enum class PaperExample { kBeams, kBunny, kDragon };

struct PlanSettings {
  std::filesystem::path root;     ///< this project's folder: bodies/, scenes/, tools/
  std::filesystem::path out;      ///< folder of all results; absolute
  std::filesystem::path program;  ///< .../bin/palpable
  bool touch = false;             ///< also make tables of touch, and a run that uses them
};

/// The steps, by names such as "bunny/film".
class PaperPlan {
 public:
  PaperPlan(PlanSettings settings, const std::vector<PaperExample>& examples);

  [[nodiscard]] const PlanSettings& settings() const { return settings_; }
  [[nodiscard]] bool has(PaperExample example) const;
  [[nodiscard]] std::vector<Step> steps() const;
  /// @throws ContractViolation unless there is such a step
  [[nodiscard]] const Step& step(std::string_view name) const;
  /// The entries of a list of paper.toml for the planned examples.
  [[nodiscard]] std::vector<PaperEntry> entries(const char* list) const;
  /// Writes the input files of steps: the scene of the beams, with the path of the baked beam.
  void write_inputs() const;

 private:
  PlanSettings settings_;
  std::vector<PaperExample> examples_;
  std::vector<std::pair<std::string, Step>> steps_;
};

}  // namespace palpable

/// @file
/// The commands that reproduce the paper's three examples (Secs. 5.1 to 5.3): bakes, films, live
/// runs and pictures, each after those whose results it needs.
#pragma once

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
  /// Writes the input files of steps: the scene of the beams, with the path of the baked beam.
  void write_inputs() const;

 private:
  void add(const std::string& name, Step step);
  void add_beams();
  void add_solid(const std::string& name, double bake_seconds);
  void add_room();
  /// Adds a live run of a film. @param words  further arguments of `palpable live`
  void add_run(const std::string& name, const std::string& what,
               const std::vector<std::string>& body, const std::string& film,
               const std::vector<std::string>& words, double seconds);
  void add_bench(const std::string& name, const std::vector<std::string>& body,
                 const std::vector<std::string>& words);

  PlanSettings settings_;
  std::vector<PaperExample> examples_;
  std::vector<std::pair<std::string, Step>> steps_;
};

/// Numbers of the film frames that the figures show.
struct FigureFrames {
  static constexpr int kBeamsAtRest = 60, kBeamsPressed = 118, kBeamsBoth = 150;
  static constexpr int kFlank = 98, kBack = 142, kHandBefore = 174, kEar = 215, kHandBehind = 248,
                       kSqueeze = 338;
};

}  // namespace palpable

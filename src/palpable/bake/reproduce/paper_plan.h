/// @file
/// The commands that make the paper's three examples (Secs. 5.1 to 5.3) again: what is baked,
/// filmed, played and drawn, in the order in which one needs the other.
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
  std::filesystem::path out;      ///< where everything goes; absolute
  std::filesystem::path program;  ///< .../bin/palpable
  bool touch = false;             ///< tables of touch, too, and a run that uses them
};

/// Steps by name, such as "bunny/film", and where what they make lies.
class PaperPlan {
 public:
  PaperPlan(PlanSettings settings, const std::vector<PaperExample>& examples);

  [[nodiscard]] const PlanSettings& settings() const { return settings_; }
  [[nodiscard]] bool has(PaperExample example) const;
  [[nodiscard]] std::vector<Step> steps() const;
  /// @throws ContractViolation unless there is such a step
  [[nodiscard]] const Step& step(std::string_view name) const;
  /// Writes the texts that steps read: the scene of the beams, with our beam in it.
  void write_inputs() const;

 private:
  void add(const std::string& name, Step step);
  void add_beams();
  void add_solid(const std::string& name, double bake_seconds);
  void add_room();
  /// Plays a film; @param words  what else is said to `palpable live`
  void add_run(const std::string& name, const std::string& what,
               const std::vector<std::string>& body, const std::string& film,
               const std::vector<std::string>& words, double seconds);
  void add_bench(const std::string& name, const std::vector<std::string>& body,
                 const std::vector<std::string>& words);

  PlanSettings settings_;
  std::vector<PaperExample> examples_;
  std::vector<std::pair<std::string, Step>> steps_;
};

/// The frames of the films that the figures show.
struct FigureFrames {
  static constexpr int kBeamsAtRest = 60, kBeamsPressed = 118, kBeamsBoth = 150;
  static constexpr int kFlank = 98, kBack = 142, kHandBefore = 174, kEar = 215, kHandBehind = 248,
                       kSqueeze = 338;
};

}  // namespace palpable

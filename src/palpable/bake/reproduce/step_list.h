/// @file
/// Runs long work as a list of commands. Each is run once, a later call does not repeat finished
/// ones, and the remaining time is reported before each.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace palpable {

/// One command and its result.
struct Step {
  std::string what = {};               ///< for people, e.g. "dragon: 32 sites x 16 levels"
  std::filesystem::path program = {};  ///< e.g. .../bin/palpable
  std::vector<std::string> words = {};
  std::filesystem::path product = {};  ///< the file it makes; complete if it exists
  double seconds = 1;                  ///< expected, on two cores
  bool is_bake = false;                ///< its time counts as the offline half's
  bool prints_product = false;         ///< its standard output is the product
  /// Folder that is removed before the command starts, for commands that do not overwrite files.
  std::filesystem::path own_folder = {};

  /// The command as a user types it, with absolute paths made relative to `base`.
  [[nodiscard]] std::string command(const std::filesystem::path& base) const;
};

/// How long steps took, over all calls.
struct StepTimes {
  double bakes = 0;   ///< s
  double others = 0;  ///< s
};

/// Runs commands one after the other and keeps a list of those that are done, `steps.json`.
class StepList {
 public:
  /// @param folder  of steps.json and logs/; made if it is not there
  /// @throws Error when steps.json cannot be read
  explicit StepList(std::filesystem::path folder);

  /// Whether the same command was finished before and its product still exists.
  [[nodiscard]] bool is_done(const Step& step) const;
  /// Runs the steps that are not done. Their standard error is passed through; their standard
  /// output goes to logs/, or is their product.
  /// @param say  called before each step with a line such as "[3 of 17] dragon: the film; some 4
  ///             min left"
  /// @throws Error where a step fails or is stopped
  void run(const std::vector<Step>& steps, const std::function<void(const std::string&)>& say);
  /// Seconds that a step took when it was run; 0: never run.
  [[nodiscard]] double seconds(const Step& step) const;
  [[nodiscard]] StepTimes times(const std::vector<Step>& steps) const;

 private:
  struct Done {
    std::string key;  // program and words
    double seconds = 0;
  };
  [[nodiscard]] const Done* find(const Step& step) const;
  void run_one(const Step& step, std::size_t number);
  void keep() const;

  std::filesystem::path folder_;
  std::vector<Done> done_;
};

}  // namespace palpable

/// @file
/// Long work as a list of commands: each is run once, what was finished stays finished, and the
/// rest of the time is told before each.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace palpable {

/// One command and what it leaves behind.
struct Step {
  std::string what = {};               ///< for people, e.g. "dragon: 32 sites x 16 levels"
  std::filesystem::path program = {};  ///< e.g. .../bin/palpable
  std::vector<std::string> words = {};
  std::filesystem::path product = {};  ///< a file that is whole when it is there
  double seconds = 1;                  ///< expected, of two cores
  bool is_bake = false;                ///< its time counts as the offline half's
  bool prints_product = false;         ///< the product is what it prints
  /// Folder that is emptied before it begins: of commands that do not write over what is there.
  std::filesystem::path own_folder = {};

  /// As a user types it; paths in `base` are written from there.
  [[nodiscard]] std::string command(const std::filesystem::path& base) const;
};

/// How long things took, over all calls.
struct StepTimes {
  double bakes = 0;   ///< s
  double others = 0;  ///< s
};

/// Runs commands one after the other and keeps a list of those that are done, `steps.json`.
class StepList {
 public:
  /// @param folder  of steps.json and logs/; made if it is not there
  /// @throws Error when steps.json is not to be read
  explicit StepList(std::filesystem::path folder);

  /// Whether the same command was finished before and what it made is still there.
  [[nodiscard]] bool is_done(const Step& step) const;
  /// Runs those that are not done. Their progress bars and complaints come through to stderr; what
  /// they print goes to logs/, or is their product.
  /// @param say  is told before each, "[3 of 17] dragon: the film; some 4 min left"
  /// @throws Error where one fails or is stopped
  void run(const std::vector<Step>& steps, const std::function<void(const std::string&)>& say);
  /// Seconds that one took when it was run; 0: never.
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

#include "palpable/desk/clip_files/timing_file.h"

#include "palpable/common/base/error.h"
#include "palpable/common/base/text_numbers.h"
#include "palpable/desk/clip_files/text_file.h"

#include <fmt/core.h>

#include <optional>
#include <sstream>

namespace palpable {
namespace {

std::vector<std::string> stages_of(const std::string& header) {
  std::vector<std::string> stages;
  std::istringstream words(header);
  std::string word;
  if (!std::getline(words, word, ',') || word != "frame") {
    throw Error("the first column is to be called frame");
  }
  while (std::getline(words, word, ',')) {
    if (!word.ends_with("_ms")) throw Error(fmt::format("column '{}' does not end in _ms", word));
    stages.push_back(word.substr(0, word.size() - 3));
  }
  return stages;
}

}  // namespace

std::string timing_header(std::span<const std::string> stages) {
  std::string text = "frame";
  for (const std::string& stage : stages) text += "," + stage + "_ms";
  return text + "\n";
}

std::string timing_line(int frame, std::span<const double> ms) {
  std::string text = fmt::format("{}", frame);
  for (const double value : ms) text += fmt::format(",{:.3f}", value);
  return text + "\n";
}

TimingTable read_timing(const std::filesystem::path& path) {
  TimingTable table;
  bool is_header = true;
  for_each_line(path, [&](const std::string& line) {
    if (is_header) {
      table.stages = stages_of(line);
      is_header = false;
      return;
    }
    const std::optional<std::vector<double>> numbers = to_numbers(line);
    if (!numbers || numbers->size() != table.stages.size() + 1) {
      throw Error(fmt::format("{} numbers are wanted", table.stages.size() + 1));
    }
    table.frames.push_back(static_cast<int>(numbers->front()));
    table.ms.emplace_back(numbers->begin() + 1, numbers->end());
  });
  return table;
}

}  // namespace palpable

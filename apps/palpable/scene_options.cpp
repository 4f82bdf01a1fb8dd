#include "apps/palpable/scene_options.h"

#include "apps/palpable/live_settings.h"
#include "palpable/common/base/text_numbers.h"
#include "palpable/desk/clip_files/json_lines.h"
#include "palpable/desk/clip_files/scene_files.h"
#include "palpable/live/sources/camera_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>
#include <utility>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;

// Options whose values are files and folders.
constexpr std::array<std::string_view, 8> kFileOptions{
    "source", "right", "depth-source", "calibration", "place", "refine", "out", "record"};

// Whether a word of an option is the name of a file or folder.
bool is_path(const std::string& option, const std::string& word) {
  if (std::find(kFileOptions.begin(), kFileOptions.end(), option) == kFileOptions.end()) {
    return false;
  }
  const bool numbers = option == "place" && to_numbers(word).has_value();
  const bool of_same_camera = option == "depth-source" && word == kDepthOfSameCamera;
  return !numbers && !of_same_camera &&
         !(option == "source" && (word == kSynthetic || word == kSocketSource));
}

std::string value_text(const std::string& word) {
  return to_number(word) ? word : quoted_text(word);
}

// `name = value`, as read_scene_options() reads it.
std::string line_of(const Command::GivenOption& option) {
  if (option.is_flag) return fmt::format("{} = true\n", option.name);
  std::vector<std::string> values;
  for (const std::string& word : option.words) {
    values.push_back(value_text(
        is_path(option.name, word) ? fs::absolute(word).lexically_normal().string() : word));
  }
  if (values.size() == 1) return fmt::format("{} = {}\n", option.name, values.front());
  return fmt::format("{} = [{}]\n", option.name, fmt::join(values, ", "));
}

// A name for a body as a scene file may have it, from that of its file.
std::string plain_name(const fs::path& file) {
  std::string name = file.stem().string();
  std::replace_if(
      name.begin(), name.end(),
      [](unsigned char c) { return std::isalnum(c) == 0 && c != '-' && c != '_'; }, '-');
  return name;
}

}  // namespace

std::vector<Command::FileOption> options_of_scene(const fs::path& scene) {
  std::vector<Command::FileOption> options;
  for (SceneOption& option : read_scene_options(scene)) {
    for (std::string& word : option.words) {
      if (is_path(option.name, word)) {
        word = (scene.parent_path() / word).lexically_normal().string();
      }
    }
    options.push_back({std::move(option.name), std::move(option.words),
                       fmt::format("{}:{}", scene.string(), option.line)});
  }
  return options;
}

std::string scene_file_text(const LiveOptions& options,
                            const std::vector<Command::GivenOption>& given) {
  std::string text = "# palpable live THIS-FILE; docs/scenes.md explains every key\n";
  const auto is_source = [](const Command::GivenOption& option) { return option.name == "source"; };
  if (std::none_of(given.begin(), given.end(), is_source)) {
    text += line_of({"source", {options.input.source}});
  }
  for (const Command::GivenOption& option : given) {
    // What belongs to the body stands with it, and the call itself is not part of the run.
    const bool elsewhere =
        option.name == "scale" || option.name == "set" || option.name == "print-config";
    if (!elsewhere) text += line_of(option);
  }
  std::vector<DescribedBody> bodies = wanted_bodies(options);
  for (DescribedBody& body : bodies) {
    if (body.name.empty()) body.name = plain_name(body.file);
  }
  return text + "\n" + scene_text(bodies);
}

}  // namespace palpable::app

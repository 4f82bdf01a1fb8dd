#include "palpable/bake/reproduce/paper_data.h"

#include "palpable/bake/exchange/web_page.h"
#include "palpable/common/base/contract.h"

#include <algorithm>
#include <optional>
#include <span>

namespace palpable {

std::span<const PageFile> reproduce_text_files();  // cmake/EmbedFiles.cmake

namespace {

const std::string kPaperFile = "paper.toml";

const toml::table& paper_table() {
  static const toml::table table = parse_toml(reproduce_text_files().front().content, kPaperFile);
  return table;
}

}  // namespace

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t at = text.find(what); at != std::string::npos;
       at = text.find(what, at + by.size())) {
    text.replace(at, what.size(), by);
  }
  return text;
}

std::string PaperEntry::filled(std::string text) const {
  for (const auto& [what, by] : values) text = replaced(std::move(text), what, by);
  return text;
}

std::string PaperEntry::text(const char* key) {
  const bool one_for_all = !section.has(key) || section.is_text(key);
  return filled(one_for_all ? section.text(key) : section.section(key).text(example.c_str()));
}

std::string PaperEntry::text_or_empty(const char* key) {
  return section.has(key) ? text(key) : std::string();
}

std::vector<std::string> PaperEntry::texts(const char* key) {
  if (!section.has(key)) return {};
  std::vector<std::string> all = section.texts(key);
  for (std::string& text : all) text = filled(text);
  return all;
}

std::vector<PaperEntry> PaperEntry::entries(const char* key) {
  std::vector<PaperEntry> all;
  for (const TomlSection& inner : section.sections(key)) all.push_back({inner, example, values});
  return all;
}

std::vector<PaperEntry> paper_entries(
    const char* list, const std::string& example,
    const std::vector<std::pair<std::string, std::string>>& values) {
  std::vector<PaperEntry> all;
  for (TomlSection section : TomlSection(kPaperFile, "", paper_table()).sections(list)) {
    const std::vector<std::string> of = section.texts("of");
    if (std::find(of.begin(), of.end(), example) == of.end()) continue;
    all.push_back({section, example, values});
  }
  return all;
}

std::vector<int> film_frames(const std::string& film) {
  const toml::table* frames = paper_table()["frames"][film].as_table();
  PALPABLE_EXPECT(frames != nullptr, "paper.toml names frames of the film");
  std::vector<int> numbers;
  for (const auto& [name, number] : *frames) numbers.push_back(number.value_or(0));
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

int film_frame(const std::string& name) {
  const std::optional<int> number = paper_table().at_path("frames." + name).value<int>();
  PALPABLE_EXPECT(number.has_value(), "paper.toml names the frame");
  return *number;
}

}  // namespace palpable

/// @file
/// Reads paper.toml, which is compiled into the program: the paper's examples as lists of commands
/// and figures. The file itself says what its entries mean.
#pragma once

#include "palpable/common/toml/toml_section.h"

#include <string>
#include <utility>
#include <vector>

namespace palpable {

/// An entry of paper.toml, read for one example.
struct PaperEntry {
  TomlSection section;
  std::string example;  ///< e.g. "bunny"
  /// What {...} of texts are replaced by.
  std::vector<std::pair<std::string, std::string>> values;

  /// A text with its {...} replaced; of a table of texts, the one of the example.
  /// @throws Error when it is missing
  [[nodiscard]] std::string text(const char* key);
  [[nodiscard]] std::string text_or_empty(const char* key);
  /// As text(), a list; empty when it is missing.
  [[nodiscard]] std::vector<std::string> texts(const char* key);
  /// The entries of a list within this one.
  [[nodiscard]] std::vector<PaperEntry> entries(const char* key);
  [[nodiscard]] std::string filled(std::string text) const;
};

/// The entries of a list ("step", "number", "figure") whose `of` names the example, in the file's
/// order.
[[nodiscard]] std::vector<PaperEntry> paper_entries(
    const char* list, const std::string& example,
    const std::vector<std::pair<std::string, std::string>>& values);

/// Numbers of the film frames that figures show: all of a film ("demo"), increasing, and one
/// ("demo.flank").
[[nodiscard]] std::vector<int> film_frames(const std::string& film);
[[nodiscard]] int film_frame(const std::string& name);

/// The text with `what` replaced by `by` everywhere.
[[nodiscard]] std::string replaced(std::string text, const std::string& what,
                                   const std::string& by);

}  // namespace palpable

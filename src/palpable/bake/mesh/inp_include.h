/// @file
/// Input decks that consist of several files.
#pragma once

#include "palpable/common/base/error.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace palpable::inp {

/// The text of a deck with all files that it includes in their places.
struct Deck {
  std::string text;
  /// From line `first` of the text on, its lines are those of `file` from `line` on. Empty where
  /// nothing is included.
  struct Part {
    std::size_t first;
    std::string file;
    std::size_t line;
  };
  std::vector<Part> parts = {};

  /// "mesh.inp: line 12", for a line of the text. @param name  of the deck itself
  [[nodiscard]] std::string place(std::size_t line, std::string_view name) const;
};

/// Reads a file as text: (path, largest size, bytes).
using ReadText = std::function<Result<std::string>(const std::filesystem::path&, std::uintmax_t)>;

/// Replaces "*INCLUDE, INPUT=file" by the file's lines, and puts the lines of a file that another
/// keyword names so ("*NODE, INPUT=nodes.txt") behind it, as Abaqus and CalculiX do.
///
/// Names are relative to the file that they stand in, else to the deck's own folder. A deck without
/// them is returned as it is.
/// @param text  the deck's own
/// @param most  largest size of all files together, bytes
/// @return the problem, which names the file and the line, for a file that cannot be read, includes
///         itself, is more than 10 files deep, or is one of more than 1000
[[nodiscard]] Result<Deck> with_includes(std::string text, const std::filesystem::path& path,
                                         std::uintmax_t most, const ReadText& read);

}  // namespace palpable::inp

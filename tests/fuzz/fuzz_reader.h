/// @file
/// Every reader of files that others may have written, by name: files that it reads, and how.
#pragma once

#include "palpable/common/base/error.h"
#include "tests/fuzz/mutations.h"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace palpable::fuzz {

struct FuzzReader {
  std::string name;
  /// Writes small valid files into an empty folder. Returns the names of those that are damaged,
  /// one at a time.
  std::function<std::vector<std::string>(const std::filesystem::path& folder)> write;
  /// Reads, and looks at what was read. What a user would be told, by an Error or as the answer;
  /// empty when nothing is wrong.
  std::function<std::string(const std::filesystem::path& folder, const std::filesystem::path& file)>
      read;
  /// Messages may name the folder instead of the file: a recording is a folder.
  bool names_folder = false;
  /// Instead of mutated(), for files with a checksum: damage behind it.
  std::function<std::string(const std::string& bytes, Random& random)> mutate = {};
};

/// What a user is told of a Result; `look` gets the value.
template <class T, class Look>
std::string said(const Result<T>& result, const Look& look) {
  if (!result.ok()) return result.problem().message;
  look(result.value());
  return {};
}

// Each adds those of its part of the project.
void add_surface_readers(std::vector<FuzzReader>& readers);
void add_mesh_readers(std::vector<FuzzReader>& readers);
void add_body_readers(std::vector<FuzzReader>& readers);
void add_campaign_readers(std::vector<FuzzReader>& readers);
void add_clip_readers(std::vector<FuzzReader>& readers);
void add_source_readers(std::vector<FuzzReader>& readers);
void add_score_readers(std::vector<FuzzReader>& readers);

}  // namespace palpable::fuzz

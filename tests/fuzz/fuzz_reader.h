/// @file
/// All readers of files that may come from other programs, by name, with valid files for each.
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
  /// Writes small valid files into an empty folder. Returns the names of those that are to be
  /// damaged, one at a time.
  std::function<std::vector<std::string>(const std::filesystem::path& folder)> write;
  /// Reads the file and uses the content. Returns the message that a user would get, from an Error
  /// or as a result; empty if nothing is wrong.
  std::function<std::string(const std::filesystem::path& folder, const std::filesystem::path& file)>
      read;
  /// The message may name the folder in place of the file, for recordings that are folders.
  bool names_folder = false;
  /// Damage used in place of mutated(), for files with a checksum.
  std::function<std::string(const std::string& bytes, Random& random)> mutate = {};
};

/// The message of a Result that is a problem; else calls `look` with its value.
template <class T, class Look>
std::string said(const Result<T>& result, const Look& look) {
  if (!result.ok()) return result.problem().message;
  look(result.value());
  return {};
}

// Each function adds the readers of one part of the project.
void add_surface_readers(std::vector<FuzzReader>& readers);
void add_mesh_readers(std::vector<FuzzReader>& readers);
void add_body_readers(std::vector<FuzzReader>& readers);
void add_campaign_readers(std::vector<FuzzReader>& readers);
void add_clip_readers(std::vector<FuzzReader>& readers);
void add_source_readers(std::vector<FuzzReader>& readers);
void add_score_readers(std::vector<FuzzReader>& readers);

}  // namespace palpable::fuzz

/// @file
/// Texts that a reader of files is given, and what it says about them.
#pragma once

#include "palpable/common/base/error.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <filesystem>
#include <functional>
#include <string>

namespace palpable::test {

/// A file with the given text in a folder of its own.
struct TextIn {
  explicit TextIn(const std::string& text, const char* name = "file") : path(folder / name) {
    write_bytes(path, text);
  }
  ScratchFolder folder{"text_in"};
  std::filesystem::path path;
};

/// The message of the Error that `read` throws for a file with this text; empty when it throws
/// none.
inline std::string refusal_of(const std::string& text,
                              const std::function<void(const std::filesystem::path&)>& read) {
  const TextIn file(text);
  try {
    read(file.path);
  } catch (const Error& error) { return error.what(); }
  return {};
}

/// Whether a message is one line with `part` in it.
inline bool says(const std::string& message, const std::string& part) {
  UNSCOPED_INFO("'" << part << "' is to be in: " << message);
  return message.find(part) != std::string::npos && message.find('\n') == std::string::npos;
}

}  // namespace palpable::test

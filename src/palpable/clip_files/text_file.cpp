#include "palpable/clip_files/text_file.h"

#include "palpable/base/error.h"

#include <fmt/core.h>

#include <cstddef>
#include <fstream>
#include <utility>

namespace palpable {

namespace {

constexpr std::size_t kMostKept = 1 << 16;  // bytes

}  // namespace

TextFile::~TextFile() {
  try {
    flush();
  } catch (const Error&) {  // nobody asked; the lines before are there
  }
}

void TextFile::write(std::string_view lines) {
  kept_ += lines;
  if (kept_.size() > kMostKept) flush();
}

void TextFile::flush() {
  if (!kept_.empty()) file_.append(std::exchange(kept_, {}));
}

void TextFile::close() {
  flush();
  file_.close();
}

void for_each_line(const std::filesystem::path& path,
                   const std::function<void(const std::string& line)>& read_line) {
  std::ifstream in(path);
  if (!in) throw Error(fmt::format("{}: cannot be read", path.string()));
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty()) continue;
    try {
      read_line(line);
    } catch (const Error& error) {
      throw Error(fmt::format("{}: line {}: {}", path.string(), number, error.what()));
    }
  }
}

}  // namespace palpable

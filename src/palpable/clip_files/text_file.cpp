#include "palpable/clip_files/text_file.h"

#include "palpable/base/error.h"

#include <fmt/core.h>

#include <utility>

namespace palpable {

TextFile::TextFile(std::filesystem::path path) : path_(std::move(path)), stream_(path_) {
  if (!stream_) throw Error(fmt::format("{}: cannot be written", path_.string()));
}

void TextFile::write(std::string_view text) { stream_ << text; }

void TextFile::close() {
  stream_.close();
  if (!stream_) throw Error(fmt::format("{}: cannot be written (disk full?)", path_.string()));
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

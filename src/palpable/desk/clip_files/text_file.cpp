#include "palpable/desk/clip_files/text_file.h"

#include "palpable/common/base/error.h"

#include <fmt/core.h>

#include <cstddef>
#include <fstream>
#include <utility>

namespace palpable {

namespace {

constexpr std::size_t kMostKept = 1 << 16;  // bytes; when more are kept, they are written

}  // namespace

TextFile::~TextFile() {
  try {
    flush();
  } catch (const Error&) {  // a destructor cannot report it; close() does
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

namespace {

constexpr std::size_t kLongestLine = 16'000'000;  // bytes; a line of hand.jsonl has about 2000

// Reads the next line without its end. @return false at the end of the file
bool next_line(std::streambuf& in, std::string& line) {
  line.clear();
  constexpr int kEnd = std::char_traits<char>::eof();
  for (int c = in.sbumpc(); c != kEnd; c = in.sbumpc()) {
    if (c == '\n') return true;
    if (line.size() == kLongestLine) throw Error("is longer than 16 MB");
    line += static_cast<char>(c);
  }
  return !line.empty();
}

}  // namespace

void for_each_line(const std::filesystem::path& path,
                   const std::function<void(const std::string& line)>& read_line) {
  std::ifstream in(path);
  if (!in) throw Error(fmt::format("{}: cannot be read", path.string()));
  int number = 1;
  try {
    for (std::string line; next_line(*in.rdbuf(), line); ++number) {
      if (!line.empty() && line.back() == '\r') line.pop_back();
      if (!line.empty()) read_line(line);
    }
  } catch (const Error& error) {
    throw Error(fmt::format("{}: line {}: {}", path.string(), number, error.what()));
  } catch (const std::ios_base::failure&) {  // `path` is a folder
    throw Error(fmt::format("{}: cannot be read", path.string()));
  }
}

}  // namespace palpable

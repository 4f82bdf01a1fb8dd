#include "palpable/desk/clip_files/text_file.h"

#include "palpable/common/base/error.h"
#include "palpable/common/base/plain_text.h"
#include "palpable/common/base/whole_file.h"

#include <fmt/core.h>

#include <cstddef>
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

// Reads the next line without its end ("\n", "\r\n", a lone "\r", or a zero byte that ends the
// file, as plain_text() allows it). @return false at the end of the file
bool next_line(std::streambuf& in, bool is_first, std::string& line) {
  line.clear();
  constexpr int kEnd = std::char_traits<char>::eof();
  for (int c = in.sbumpc(); c != kEnd; c = in.sbumpc()) {
    if (c == '\n') return true;
    if (c == '\r') {
      if (in.sgetc() == '\n') in.sbumpc();
      return true;
    }
    const bool begins_file = is_first && line.empty();
    if (c == '\0' && in.sgetc() == kEnd && !begins_file) return !line.empty();
    if (c == '\0') throw Error(std::string(kZeroByte));
    if (line.size() == kLongestLine) throw Error("is longer than 16 MB");
    line += static_cast<char>(c);
  }
  return !line.empty();
}

}  // namespace

LineReader::LineReader(const std::filesystem::path& path) : path_(path) {
  if (const std::string why = why_no_file(path); !why.empty()) {
    throw Error(fmt::format("{}: {}", path.string(), why));
  }
  in_.open(path, std::ios::binary);
  if (!in_) throw Error(fmt::format("{}: cannot be read", path.string()));
}

std::string LineReader::where() const {
  return fmt::format("{}: line {}: ", path_.string(), number_);
}

bool LineReader::next(std::string& line) {
  try {
    while (true) {
      ++number_;
      if (!next_line(*in_.rdbuf(), number_ == 1, line)) return false;
      if (number_ == 1) {
        if (const std::string why = why_no_text(line, TextPart::kFirst); !why.empty()) {
          throw Error(why);
        }
        line.erase(0, line.size() - without_mark(line).size());
      }
      if (!line.empty()) return true;
    }
  } catch (const Error& error) {
    throw Error(where() + error.what());
  } catch (const std::ios_base::failure&) {
    throw Error(fmt::format("{}: cannot be read", path_.string()));
  }
}

void for_each_line(const std::filesystem::path& path,
                   const std::function<void(const std::string& line)>& read_line) {
  LineReader lines(path);
  for (std::string line; lines.next(line);) {
    try {
      read_line(line);
    } catch (const Error& error) { throw Error(lines.where() + error.what()); }
  }
}

}  // namespace palpable

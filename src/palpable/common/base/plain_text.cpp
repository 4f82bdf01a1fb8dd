#include "palpable/common/base/plain_text.h"

#include <fmt/format.h>

#include <cstddef>
#include <utility>

namespace palpable {
namespace {

constexpr std::string_view kMark = "\xef\xbb\xbf";

// The number of the line, from 1, in which a byte lies; lines end with \n, \r\n or \r.
std::size_t line_at(std::string_view bytes, std::size_t at) {
  std::size_t line = 1;
  for (std::size_t i = 0; i < at; ++i) {
    const bool is_lone_return = bytes[i] == '\r' && i + 1 < bytes.size() && bytes[i + 1] != '\n';
    if (bytes[i] == '\n' || is_lone_return) ++line;
  }
  return line;
}

// Replaces the line ends by "\n", in place.
void unify_line_ends(std::string& text) {
  std::size_t out = text.find('\r');
  if (out == std::string::npos) return;
  for (std::size_t i = out; i < text.size(); ++i) {
    if (text[i] == '\r') {
      text[out++] = '\n';
      if (i + 1 < text.size() && text[i + 1] == '\n') ++i;
    } else {
      text[out++] = text[i];
    }
  }
  text.resize(out);
}

}  // namespace

std::string_view without_mark(std::string_view text) {
  if (text.starts_with(kMark)) text.remove_prefix(kMark.size());
  return text;
}

bool is_utf16(std::string_view text) {
  return text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff");
}

std::string why_no_text(std::string_view bytes, TextPart part) {
  if (is_utf16(bytes)) return "is UTF-16: save it as UTF-8";
  const std::size_t zero = bytes.find('\0');
  if (zero == std::string_view::npos) return {};
  if (part == TextPart::kAll && zero > 0 && zero + 1 == bytes.size()) return {};
  return fmt::format("line {}: {}", line_at(bytes, zero), kZeroByte);
}

Result<std::string> plain_text(std::string bytes) {
  if (std::string why = why_no_text(bytes, TextPart::kAll); !why.empty()) {
    return Problem{std::move(why)};
  }
  if (bytes.ends_with('\0')) bytes.pop_back();
  if (bytes.starts_with(kMark)) bytes.erase(0, kMark.size());
  unify_line_ends(bytes);
  return bytes;
}

}  // namespace palpable

#include "palpable/common/base/markup_text.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace palpable {
namespace {

struct Form {
  unsigned char mask, first;  // the first byte of a character of this length
  std::uint32_t least;        // smaller code points have a shorter form
};
constexpr std::array<Form, 4> kForms{
    {{0x80, 0x00, 0}, {0xe0, 0xc0, 0x80}, {0xf0, 0xe0, 0x800}, {0xf8, 0xf0, 0x10000}}};

bool is_allowed(std::uint32_t letter) {
  if (letter < 0x20) return letter == '\t' || letter == '\n' || letter == '\r';
  return letter != 0x7f && !(letter >= 0xd800 && letter <= 0xdfff) && letter != 0xfffe &&
         letter != 0xffff && letter <= 0x10ffff;
}

// Number of bytes of the character that `text` begins with; 0 if it is not one that XML allows.
std::size_t length_of_first(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  for (std::size_t length = 1; length <= kForms.size() && length <= text.size(); ++length) {
    const Form& form = kForms[length - 1];
    if ((byte(0) & form.mask) != form.first) continue;
    std::uint32_t letter = byte(0) & static_cast<unsigned char>(~form.mask);
    for (std::size_t i = 1; i < length; ++i) {
      if ((byte(i) & 0xc0) != 0x80) return 0;
      letter = letter << 6 | (byte(i) & 0x3f);
    }
    return letter >= form.least && is_allowed(letter) ? length : 0;
  }
  return 0;
}

}  // namespace

std::string markup_text(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    const std::size_t length = length_of_first(text);
    if (length == 0) {
      result += "\xef\xbf\xbd";
    } else if (text[0] == '&') {
      result += "&amp;";
    } else if (text[0] == '<') {
      result += "&lt;";
    } else if (text[0] == '>') {
      result += "&gt;";
    } else if (text[0] == '"') {
      result += "&quot;";
    } else {
      result += text.substr(0, length);
    }
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return result;
}

bool fits_in_markup(std::string_view text) {
  while (!text.empty()) {
    const std::size_t length = length_of_first(text);
    if (length == 0) return false;
    text.remove_prefix(length);
  }
  return true;
}

}  // namespace palpable

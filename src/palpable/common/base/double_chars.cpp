#include "palpable/common/base/double_chars.h"

#ifndef __cpp_lib_to_chars
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <string>
#include <string_view>
#endif

namespace palpable {

#ifdef __cpp_lib_to_chars

std::from_chars_result double_from_chars(const char* first, const char* last, double& value) {
  return std::from_chars(first, last, value);
}

#else

namespace {

// Whether strtod() would read a text that from_chars() refuses or reads otherwise: "+1", " 1", and
// "0x1", of which from_chars() reads the zero.
bool starts_unlike_from_chars(std::string_view text) {
  if (text.empty() || text.front() == '+') return true;
  return std::isspace(static_cast<unsigned char>(text.front())) != 0;
}
std::string_view up_to_hexadecimal(std::string_view text) {
  const std::size_t digits = text.starts_with('-') ? 1 : 0;
  const bool is_hexadecimal = text.size() > digits + 1 && text[digits] == '0' &&
                              (text[digits + 1] == 'x' || text[digits + 1] == 'X');
  return is_hexadecimal ? text.substr(0, digits + 1) : text;
}

}  // namespace

// Emscripten knows the locale "C" alone, whose point strtod() expects.
std::from_chars_result double_from_chars(const char* first, const char* last, double& value) {
  const std::string_view text(first, static_cast<std::size_t>(last - first));
  if (starts_unlike_from_chars(text)) return {first, std::errc::invalid_argument};
  const std::string copy(up_to_hexadecimal(text));
  char* end = nullptr;
  errno = 0;
  const double read = std::strtod(copy.c_str(), &end);
  const auto length = end - copy.c_str();
  if (length == 0) return {first, std::errc::invalid_argument};
  if (errno == ERANGE && (read == 0 || std::isinf(read)))
    return {first + length, std::errc::result_out_of_range};
  value = read;
  return {first + length, std::errc()};
}

#endif

}  // namespace palpable

#include "palpable/common/base/text_numbers.h"

#include "palpable/common/base/double_chars.h"
#include "palpable/common/base/whole_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <system_error>
#include <type_traits>

namespace palpable {
namespace {

constexpr std::uintmax_t kLargestFile = 64u << 20;  // bytes; an hour of ground truth takes 40 MB
constexpr std::string_view kSeparators = " \t\r\n,;[]";

template <class T>
std::optional<T> whole_text(std::string_view text) {
  if (text.starts_with('+')) {  // from_chars does not accept it
    text.remove_prefix(1);
    if (text.starts_with('-')) return std::nullopt;
  }
  T value{};
  const char* const last = text.data() + text.size();
  std::from_chars_result read;
  if constexpr (std::is_same_v<T, double>) {
    read = double_from_chars(text.data(), last, value);
  } else {
    read = std::from_chars(text.data(), last, value);
  }
  const auto [end, error] = read;
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

std::optional<double> to_number(std::string_view text) {
  const std::optional<double> value = to_any_number(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<double> to_any_number(std::string_view text) { return whole_text<double>(text); }

std::optional<long long> to_whole_number(std::string_view text) {
  return whole_text<long long>(text);
}

bool has_decimal_commas(std::string_view line) {
  constexpr std::string_view kBetween = " \t\r\n;[]";
  if (line.find(',') == std::string_view::npos) return false;
  int words = 0, with_comma = 0;
  for (std::size_t at = line.find_first_not_of(kBetween); at != std::string_view::npos;
       at = line.find_first_not_of(kBetween, at)) {
    const std::size_t end = std::min(line.find_first_of(kBetween, at), line.size());
    std::string word(line.substr(at, end - at));
    at = end;
    ++words;
    const std::size_t comma = word.find(',');
    const auto is_digit = [&](std::size_t i) {
      return i < word.size() && word[i] >= '0' && word[i] <= '9';
    };
    if (comma != std::string::npos) {
      if (comma == 0 || !is_digit(comma - 1) || !is_digit(comma + 1)) return false;
      word[comma] = '.';
      ++with_comma;
    }
    if (!to_any_number(word)) return false;  // a second comma, a second point or a word
  }
  return words >= 2 && with_comma >= 1;
}

std::optional<std::vector<double>> to_numbers(std::string_view text) {
  if (has_decimal_commas(text)) return std::nullopt;
  std::vector<double> numbers;
  for (std::size_t at = text.find_first_not_of(kSeparators); at != std::string_view::npos;
       at = text.find_first_not_of(kSeparators, at)) {
    const std::size_t end = std::min(text.find_first_of(kSeparators, at), text.size());
    const auto value = to_number(text.substr(at, end - at));
    if (!value) return std::nullopt;
    numbers.push_back(*value);
    at = end;
  }
  return numbers;
}

std::map<std::string, double> parse_settings(const std::vector<std::string>& texts,
                                             std::string_view option, std::string_view what) {
  std::map<std::string, double> values;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    const std::optional<double> value =
        equals == std::string::npos ? std::nullopt : to_number(text.substr(equals + 1));
    if (!value || equals == 0) {
      throw Error(fmt::format("{} {}: must be a parameter and {}", option, text, what));
    }
    if (!values.emplace(text.substr(0, equals), *value).second) {
      throw Error(fmt::format("{} {}: '{}' has a value already; give it once", option, text,
                              text.substr(0, equals)));
    }
  }
  return values;
}

std::string number_text(double value, double relative) {
  std::string text;
  for (int digits = 4; digits <= std::numeric_limits<double>::max_digits10; ++digits) {
    text = fmt::format("{:.{}g}", value, digits);
    const std::optional<double> told = to_number(text);
    if (told && std::abs(*told - value) <= relative * std::abs(value)) break;
  }
  return text;
}

bool is_image_side(double pixels) {
  return pixels >= 1 && pixels <= 16384 && pixels == std::floor(pixels);
}

Result<std::vector<std::string>> read_lines(const std::filesystem::path& path) {
  const Result<std::string> text = read_text_file(path, {.most = kLargestFile});
  if (!text) return text.problem();
  std::vector<std::string> lines;
  for (std::string_view rest = text.value(); !rest.empty();) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    std::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    line = line.substr(0, line.find('#'));
    while (line.ends_with(' ') || line.ends_with('\t')) line.remove_suffix(1);
    if (!line.empty()) lines.emplace_back(line);
  }
  return lines;
}

}  // namespace palpable

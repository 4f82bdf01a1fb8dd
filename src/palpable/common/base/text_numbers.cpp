#include "palpable/common/base/text_numbers.h"

#include "palpable/common/base/error.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <system_error>

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
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
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

std::optional<std::vector<double>> to_numbers(std::string_view text) {
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
    values[text.substr(0, equals)] = *value;
  }
  return values;
}

bool is_image_side(double pixels) {
  return pixels >= 1 && pixels <= 16384 && pixels == std::floor(pixels);
}

std::optional<std::vector<std::string>> read_lines(const std::filesystem::path& path) {
  std::error_code error;
  if (std::filesystem::file_size(path, error) > kLargestFile || error) return std::nullopt;
  std::ifstream in(path, std::ios::binary);
  if (!in) return std::nullopt;
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) {
    line.resize(std::min(line.find('#'), line.size()));
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ' || line.back() == '\t')) {
      line.pop_back();
    }
    if (!line.empty()) lines.push_back(line);
  }
  return lines;
}

}  // namespace palpable

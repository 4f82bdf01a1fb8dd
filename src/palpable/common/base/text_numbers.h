/// @file
/// Reads numbers from small text files, independently of the locale.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpable {

/// Nothing if the text is not exactly one finite number; a leading + is allowed.
[[nodiscard]] std::optional<double> to_number(std::string_view text);

/// The same, but nan and inf are accepted: for columns that are not used, such as the normals of a
/// scan.
[[nodiscard]] std::optional<double> to_any_number(std::string_view text);

/// Nothing if the text is not exactly one whole number that fits; a leading + or - is allowed.
[[nodiscard]] std::optional<long long> to_whole_number(std::string_view text);

/// All numbers of a text, separated by white space, commas, semicolons or square brackets. Nothing
/// when the text holds anything else.
[[nodiscard]] std::optional<std::vector<double>> to_numbers(std::string_view text);

/// Parses texts of the form "ears=0.5" with a finite number. @throws Error for another form; its
/// message asks for a parameter and `what`
/// @param option  the option before the texts, for the message
[[nodiscard]] std::map<std::string, double> parse_settings(
    const std::vector<std::string>& texts, std::string_view option = "--set",
    std::string_view what = "its value, such as stiffness=2");

/// Whether a number is a whole count of pixels that an image may have in a row or column.
[[nodiscard]] bool is_image_side(double pixels);

/// The lines of a text file without '#' comments, line ends and empty lines. Nothing if the file
/// cannot be read or has more than 64 MB.
[[nodiscard]] std::optional<std::vector<std::string>> read_lines(const std::filesystem::path& path);

}  // namespace palpable

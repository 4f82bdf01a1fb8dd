/// @file
/// Reads numbers from small text files, independently of the locale.
#pragma once

#include "palpable/common/base/error.h"

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
/// when the text holds anything else, or when has_decimal_commas().
[[nodiscard]] std::optional<std::vector<double>> to_numbers(std::string_view text);

/// Parses texts of the form "ears=0.5" with a finite number. @throws Error for another form, whose
/// message asks for a parameter and `what`, and for a parameter that is given twice
/// @param option  the option before the texts, for the message
[[nodiscard]] std::map<std::string, double> parse_settings(
    const std::vector<std::string>& texts, std::string_view option = "--set",
    std::string_view what = "its value, such as stiffness=2");

/// The number with as few digits as tell it, four at least ("6e+04", "60001", "0.4999").
/// @param relative  accuracy of the text: 1e-14 for what somebody typed, 1e-9 for what was computed
[[nodiscard]] std::string number_text(double value, double relative = 1e-9);

/// Whether a number is a whole count of pixels that an image may have in a row or column.
[[nodiscard]] bool is_image_side(double pixels);

/// Whether the numbers of a line have decimal commas: "0,5 1,25", "3;0,5;-1,25". to_numbers() would
/// read each of them as two. True if all of the words between spaces and semicolons, two at least,
/// are numbers and some have one comma between digits.
[[nodiscard]] bool has_decimal_commas(std::string_view line);

/// What a message says about has_decimal_commas().
inline constexpr std::string_view kDecimalCommas =
    "has decimal commas; write 0.5, not 0,5, and spaces between numbers";

/// The lines of a text file without '#' comments, line ends and empty lines. The problem, for a
/// file that cannot be read, is no text or has more than 64 MB, is a reason without the file's
/// name.
[[nodiscard]] Result<std::vector<std::string>> read_lines(const std::filesystem::path& path);

}  // namespace palpable

/// @file
/// Summarises the content of a body file, for users and for other programs.
#pragma once

#include "palpable/common/base/json.h"
#include "palpable/common/reduced/reduced_body.h"

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace palpable {

/// Lines (name, text) under a heading.
struct FactGroup {
  std::string heading;
  std::vector<std::pair<std::string, std::string>> lines;
};

/// Sizes, material, sites, loads, modes and their errors. Lengths in mm, loads in N; errors are
/// relative, L2, in per cent.
/// @param file     from which the body was read; its size is one of the facts
/// @param setting  how to choose another value of a further parameter: "0.5 unless <setting>"
[[nodiscard]] std::vector<FactGroup> body_facts(const ReducedBody& body,
                                                const std::filesystem::path& file,
                                                std::string_view setting);

/// 0.0123 as "1.23 %".
[[nodiscard]] std::string percent_text(double ratio);

/// A text with its pressures of 1000 Pa and more in kPa, MPa or GPa: "6e+04 Pa" as "60 kPa".
[[nodiscard]] std::string with_larger_pascals(std::string_view text);

/// The same in SI units as an object, without the file's size, with the provenance.
[[nodiscard]] Json json_of(const ReducedBody& body);

}  // namespace palpable

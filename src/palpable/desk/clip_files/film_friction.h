/// @file
/// truth/friction.txt of a clip: Coulomb's coefficient of friction with which its true skins were
/// solved, between the things that move and the bodies, and between the bodies. One number:
///
///     0.3
///
/// Clips without the file are without friction.
#pragma once

#include <filesystem>
#include <optional>

namespace palpable {

/// @param clip  the folder that holds truth/
/// @return nothing if the clip has no such file
/// @throws Error naming the file if it is no number from 0 to 10
[[nodiscard]] std::optional<double> read_film_friction(const std::filesystem::path& clip);

/// @throws Error if the file cannot be written
void write_film_friction(const std::filesystem::path& clip, double coefficient);

}  // namespace palpable

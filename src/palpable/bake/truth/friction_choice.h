/// @file
/// Which coefficient of friction the truth of a clip is solved with.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

namespace palpable {

/// The coefficient that was asked for; without one, that which the clip states (film_friction.h);
/// without that, 0. The clip states it from then on.
/// @param folders  of the results, truth/deformed or those of the bodies of a scene
/// @throws Error if a folder holds solutions with another coefficient, and as read_film_friction()
[[nodiscard]] double choose_friction(const std::filesystem::path& clip, std::optional<double> asked,
                                     const std::vector<std::filesystem::path>& folders);

}  // namespace palpable

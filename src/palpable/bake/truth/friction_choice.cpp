#include "palpable/bake/truth/friction_choice.h"

#include "palpable/common/base/error.h"
#include "palpable/desk/clip_files/film_friction.h"

#include <fmt/core.h>

#include <system_error>

namespace palpable {

double choose_friction(const std::filesystem::path& clip, std::optional<double> asked,
                       const std::vector<std::filesystem::path>& folders) {
  const double stated = read_film_friction(clip).value_or(0.0);
  const double chosen = asked.value_or(stated);
  if (chosen == stated) return chosen;
  for (const std::filesystem::path& folder : folders) {
    std::error_code error;
    if (!std::filesystem::exists(folder / "deformed.jsonl", error)) continue;
    throw Error(
        fmt::format("{}: holds solutions with a coefficient of friction of {:g}, and {:g} was "
                    "asked for; remove it "
                    "to solve anew",
                    folder.string(), stated, chosen));
  }
  write_film_friction(clip, chosen);
  return chosen;
}

}  // namespace palpable

#include "apps/palpable-bake/description_argument.h"

#include "palpable/base/error.h"
#include "palpable/describe/first_description.h"

#include <fmt/core.h>

#include <cstdio>
#include <filesystem>
#include <system_error>

namespace palpable::app {

BodyDescription read_description(const std::string& file) {
  std::error_code error;
  if (std::filesystem::is_directory(file, error)) {
    throw Error(
        fmt::format("{}: is a folder, and this wants a body's description, BODY.toml "
                    "(docs/body.md); of a folder of "
                    "snapshots palpable reduce makes a body",
                    file));
  }
  if (file.ends_with(".palpable")) {
    throw Error(
        fmt::format("{}: is a baked body, and this wants the description it was made of, BODY.toml "
                    "(docs/body.md)",
                    file));
  }
  if (!is_shape_file(file)) return read_body_description(file);
  fmt::print(stderr, "{}", first_description(file));
  const std::filesystem::path toml = std::filesystem::path(file).replace_extension(".toml");
  throw Error(
      fmt::format("{}: is a shape, and this wants a description of a body that has it: save the "
                  "lines above as {}, look through them, and name that file (docs/body.md)",
                  file, toml.string()));
}

}  // namespace palpable::app

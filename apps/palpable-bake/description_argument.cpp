#include "apps/palpable-bake/description_argument.h"

#include "apps/common/command_line.h"
#include "palpable/bake/describe/first_description.h"
#include "palpable/common/base/error.h"

#include <fmt/core.h>

#include <cstdio>
#include <filesystem>

namespace palpable::app {

BodyDescription read_description(const std::string& file) {
  if (!is_shape_file(file)) return read_body_description(file);
  fmt::print(stderr, "{}", first_description(file));
  const std::filesystem::path toml = std::filesystem::path(file).replace_extension(".toml");
  throw Error(
      fmt::format("{}: is a shape, and this wants a description of a body that has it: save the "
                  "lines above as {}, look through them, and name that file (docs/body.md)",
                  file, toml.string()));
}

void add_description(Command command, std::string& file) {
  command.add_option("description,--description", file, "Description of the body (docs/body.md)")
      .required()
      .type_name("FILE.toml");
}

}  // namespace palpable::app

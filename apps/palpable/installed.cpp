#include "apps/palpable/installed.h"

#include "palpable/common/base/error.h"
#include "palpable/common/base/this_machine.h"

#include <fmt/core.h>

#include <array>
#include <system_error>

namespace palpable::app {

namespace fs = std::filesystem;

fs::path sibling_program(std::string_view name) { return folder_of_program() / name; }

fs::path shipped_bodies() {
  return folder_of_program().parent_path() / "share" / "palpable" / "bodies";
}

fs::path shipped_page() {
  fs::path installed = folder_of_program().parent_path() / "share" / "palpable" / "web";
  std::error_code ignored;
  return fs::exists(installed, ignored) ? installed : fs::path("web/dist/page");
}

fs::path default_body() {
  const std::array bodies = {fs::path("build/bodies/bunny-dense.palpable"),
                             fs::path("out/demo/bunny.palpable"),
                             shipped_bodies() / "post.palpable"};
  for (const fs::path& body : bodies) {
    if (fs::exists(body)) return body;
  }
  throw Error(fmt::format("none of {}, {} and {} is there; bake one, or name a body file",
                          bodies[0].string(), bodies[1].string(), bodies[2].string()));
}

fs::path shipped_body() {
  const fs::path post = shipped_bodies() / "post.palpable";
  std::error_code ignored;
  return fs::exists(post, ignored) ? post : default_body();
}

fs::path find_body(const fs::path& name, const fs::path& shipped) {
  std::error_code ignored;
  if (name.empty() || name.has_parent_path() || name.has_extension()) return name;
  if (fs::exists(name, ignored)) return name;
  fs::path body = shipped / name;
  body += ".palpable";
  if (fs::exists(body, ignored)) return body;
  throw Error(
      fmt::format("{}: neither a file nor a body that is installed in {}; the file of a body "
                  "ends in .palpable",
                  name.string(), shipped.string()));
}

fs::path find_body(const fs::path& name) { return find_body(name, shipped_bodies()); }

}  // namespace palpable::app

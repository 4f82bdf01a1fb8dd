#include "apps/palpable/installed.h"

#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <string>

namespace palpable::app {
namespace {

namespace fs = std::filesystem;

TEST_CASE("a bare word is the installed body of that name, and nothing else is", "[apps][body]") {
  const test::ScratchFolder shipped("shipped_bodies");
  test::write_bytes(shipped / "post.palpable", "a body");
  const fs::path post = shipped / "post.palpable";
  CHECK(find_body("post", shipped.path()) == post);
  CHECK_THROWS_WITH(find_body("bunny", shipped.path()),
                    Catch::StartsWith("bunny: neither a file nor a body that is installed in"));
  // Paths, and names with an extension, are not looked up.
  CHECK(find_body("post.palpable", shipped.path()) == "post.palpable");
  CHECK(find_body("./post", shipped.path()) == "./post");
  CHECK(find_body("bodies/post", shipped.path()) == "bodies/post");
  CHECK(find_body("", shipped.path()).empty());
}

TEST_CASE("a file of the user's goes before the installed body of the same name", "[apps][body]") {
  const test::ScratchFolder here("own_body");
  test::write_bytes(here / "shipped/post.palpable", "a body");
  const fs::path before = fs::current_path();
  fs::current_path(here.path());
  test::write_bytes(here / "post", "a body of the user's");
  const fs::path found = find_body("post", here / "shipped");
  fs::current_path(before);
  CHECK(found == "post");
}

}  // namespace
}  // namespace palpable::app

#include "palpable/live/live_page/page_access.h"

#include "tests/support/test.h"

#include <string>

namespace palpable {
namespace {

constexpr int kPort = 4321;
const std::string kToken = "0123456789abcdef0123456789abcdef";  // NOLINT

PageRequest good() {
  return {.method = "GET",
          .target = "/0123456789abcdef0123456789abcdef/page.js",
          .host = "127.0.0.1:4321"};
}

TEST_CASE("a token has 128 bits that no two runs share", "[live_page][access]") {
  const std::string one = new_page_token(), other = new_page_token();
  CHECK(one.size() == 32);
  CHECK(one.find_first_not_of("0123456789abcdef") == std::string::npos);
  CHECK(one != other);
}

TEST_CASE("secrets are the same if every letter is", "[live_page][access]") {
  CHECK(is_same_secret("abc", "abc"));
  CHECK_FALSE(is_same_secret("abc", "abd"));
  CHECK_FALSE(is_same_secret("abc", "Abc"));
  CHECK_FALSE(is_same_secret("abc", "ab"));
  CHECK_FALSE(is_same_secret("", "a"));
}

TEST_CASE("whoever has the token reads the page by this machine's names", "[live_page][access]") {
  CHECK(page_access(good(), kToken, kPort).status == 200);
  CHECK(page_access(good(), kToken, kPort).name == "page.js");
  PageRequest request = good();
  request.target = "/0123456789abcdef0123456789abcdef/?x#y";
  request.host = "LOCALHOST:4321";
  request.origin = "http://localhost:4321";
  CHECK(page_access(request, kToken, kPort).status == 200);
  CHECK(page_access(request, kToken, kPort).name.empty());
  request.method = "HEAD";
  CHECK(page_access(request, kToken, kPort).status == 200);
}

TEST_CASE("another token, host or origin is refused", "[live_page][access]") {
  for (const char* target :
       {"/", "/page.js", "//page.js", "/0123456789abcdef0123456789abcdef",
        "/0123456789abcdef0123456789abcdee/page.js", "/0123456789ABCDEF0123456789abcdef/page.js",
        "/0123456789abcdef0123456789abcdef0/page.js", "/?/0123456789abcdef0123456789abcdef/"}) {
    INFO(target);
    PageRequest request = good();
    request.target = target;
    CHECK(page_access(request, kToken, kPort).status == 403);
  }
  for (const char* host : {"", "evil.example:4321", "127.0.0.1", "127.0.0.1:80", "0.0.0.0:4321"}) {
    INFO(host);
    PageRequest request = good();
    request.host = host;
    CHECK(page_access(request, kToken, kPort).status == 403);
  }
  PageRequest none = good();
  none.host.reset();
  CHECK(page_access(none, kToken, kPort).status == 403);
  for (const char* origin :
       {"", "null", "http://evil.example", "https://127.0.0.1:4321", "http://127.0.0.1",
        "http://127.0.0.1:4322", "http://127.0.0.1:4321.evil.example", "127.0.0.1:4321"}) {
    INFO(origin);
    PageRequest request = good();
    request.origin = origin;
    CHECK(page_access(request, kToken, kPort).status == 403);
  }
}

TEST_CASE("nothing can be sent to the page but questions", "[live_page][access]") {
  PageRequest request = good();
  request.method = "POST";
  CHECK(page_access(request, kToken, kPort).status == 405);
  request.method = "HEAD";
  request.upgrades = true;
  CHECK(page_access(request, kToken, kPort).status == 405);
  request = good();
  request.target = "page.js";
  CHECK(page_access(request, kToken, kPort).status == 400);
}

}  // namespace
}  // namespace palpable

#include "palpable/common/base/plain_text.h"

#include "tests/support/test.h"

#include <string>

namespace palpable {
namespace {

using namespace std::string_literals;

std::string plain(const std::string& bytes) { return value_or_throw(plain_text(bytes)); }
std::string refused(const std::string& bytes) { return plain_text(bytes).problem().message; }

TEST_CASE("a text is the same whatever editor or system wrote it", "[base][plain_text]") {
  const std::string text = "v 0 0 0\nv 1 0 0\n\nf 1 2 3\n";
  CHECK(plain(text) == text);
  CHECK(plain("\xef\xbb\xbf" + text) == text);
  CHECK(plain("v 0 0 0\r\nv 1 0 0\r\n\r\nf 1 2 3\r\n") == text);
  CHECK(plain("v 0 0 0\rv 1 0 0\r\rf 1 2 3\r") == text);
  CHECK(plain("v 0 0 0\r\nv 1 0 0\r\nf 1 2 3\n") == "v 0 0 0\nv 1 0 0\nf 1 2 3\n");
  CHECK(plain(text + "\0"s) == text);  // some programs write a string with its end
  CHECK(plain("caf\xe9 \xc3\xa9") == "caf\xe9 \xc3\xa9");
  CHECK(plain("").empty());
  CHECK(plain("\xef\xbb\xbf").empty());
}

TEST_CASE("what is no text is refused with the line", "[base][plain_text][refusal]") {
  CHECK(refused("\xff\xfeO\0F\0F\0"s) == "is UTF-16: save it as UTF-8");
  CHECK(refused("\xfe\xff\0O\0F\0F"s) == "is UTF-16: save it as UTF-8");
  CHECK(refused("O\0F\0F\0\n\0"s).starts_with("line 1: a zero byte"));
  CHECK(refused("1\n2\r3\r\n4\0 5\n"s).starts_with("line 4: a zero byte"));
  CHECK(refused("1\n\0\0"s).starts_with("line 2: a zero byte"));
  CHECK(refused("\0"s).starts_with("line 1: a zero byte"));
}

TEST_CASE("the first bytes of a text are judged without their end", "[base][plain_text]") {
  CHECK(why_no_text("abc\0"s, TextPart::kAll).empty());
  CHECK(why_no_text("abc\0"s, TextPart::kFirst).starts_with("line 1: a zero byte"));
  CHECK(why_no_text("abc", TextPart::kFirst).empty());
}

}  // namespace
}  // namespace palpable

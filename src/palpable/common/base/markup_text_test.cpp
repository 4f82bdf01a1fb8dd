#include "palpable/common/base/markup_text.h"

#include "tests/support/test.h"

#include <string>

namespace palpable {
namespace {

const std::string kNoLetter = "\xef\xbf\xbd";

TEST_CASE("marks of XML become entities, and all other text stays", "[base][markup]") {
  CHECK(markup_text("a & b <c> \"d\" 'e'") == "a &amp; b &lt;c&gt; &quot;d&quot; 'e'");
  for (const char* text : {"", "two\n\tlines\r", "caf\u00e9", "\u20ac \uffee", "\U0001f407"}) {
    INFO(text);
    CHECK(markup_text(text) == text);
    CHECK(fits_in_markup(text));
  }
}

TEST_CASE("what XML cannot hold is replaced, byte by byte", "[base][markup]") {
  for (const std::string& bad :
       {std::string("\0", 1), std::string("\x01"), std::string("\x1b"), std::string("\x7f"),
        std::string("\xe9"),                       // Latin-1
        std::string("\x80"), std::string("\xff"),  // begins nothing
        std::string("\xe2\x82"),                   // cut off
        std::string("\xc0\xaf"),                   // '/', longer than it needs to be
        std::string("\xed\xa0\x80"),               // half of a pair of UTF-16
        std::string("\xef\xbf\xbe"),               // U+FFFE
        std::string("\xf4\x90\x80\x80")}) {        // behind the last letter
    CHECK_FALSE(fits_in_markup(bad));
    std::string wanted = "a";
    for (std::size_t i = 0; i < bad.size(); ++i) wanted += kNoLetter;
    CHECK(markup_text("a" + bad + "<b") == wanted + "&lt;b");
  }
}

}  // namespace
}  // namespace palpable

#include "palpable/common/base/wrapped_text.h"

#include "tests/support/test.h"

#include <sstream>
#include <string>

namespace palpable {
namespace {

TEST_CASE("a text is broken at spaces, and continuation lines are indented", "[base][text]") {
  CHECK(wrapped("one two three four", 4, 4, 14) == "one two\n    three four");
  CHECK(wrapped("one two three four", 4, 2, 16) == "one two\n  three four");
  CHECK(wrapped("ten columns", 0, 0, 11) == "ten columns");
  CHECK(wrapped("ten columns", 0, 0, 10) == "ten\ncolumns");
  CHECK(wrapped("", 4, 4, 10).empty());
  CHECK(wrapped("a  b", 0, 0, 10) == "a  b");
}

TEST_CASE("a word that is wider than a line stays whole", "[base][text]") {
  CHECK(wrapped("a /very/long/path b", 2, 2, 10) == "a\n  /very/long/path\n  b");
}

TEST_CASE("a letter takes one column, however many bytes it has", "[base][text]") {
  CHECK(wrapped("\u00e4\u00e4\u00e4 \u03c3\u03c3", 0, 0, 6) == "\u00e4\u00e4\u00e4 \u03c3\u03c3");
  CHECK(wrapped("\u00e4\u00e4\u00e4 \u03c3\u03c3", 0, 0, 5) == "\u00e4\u00e4\u00e4\n\u03c3\u03c3");
}

TEST_CASE("each line is wrapped on its own, rows of a table in their last column", "[base][text]") {
  CHECK(wrapped_lines("one two three\nfour", 9) == "one two\nthree\nfour\n");
  CHECK(wrapped_lines("  ab   3  one two three", 17) == "  ab   3  one two\n          three\n");
  CHECK(wrapped_lines("  ab   3  one", 17) == "  ab   3  one\n");
  CHECK(wrapped_lines("", 9).empty());
}

TEST_CASE("a long example stays one command for a shell", "[base][text]") {
  CHECK(wrapped_lines("Example: go --place \"0 0 1\" --out out x", 26) ==
        "Example: go \\\n           --place \"0 0 1\" \\\n           --out out x\n");
  CHECK(wrapped_lines("Example: go --out out", 24) == "Example: go --out out\n");
}

}  // namespace
}  // namespace palpable

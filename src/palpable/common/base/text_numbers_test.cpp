#include "palpable/common/base/text_numbers.h"

#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace palpable {
namespace {

TEST_CASE("a text is one finite number or none", "[base][text]") {
  CHECK(to_number("1.5e-3") == 1.5e-3);
  CHECK(to_number("+7") == 7);
  CHECK(to_number("-0.25") == -0.25);
  for (const char* text :
       {"", " 1", "1 ", "1,5", "nan", "inf", "1e999", "0x10", "one", "+-1", "++1"}) {
    INFO(text);
    CHECK_FALSE(to_number(text));
  }
}

TEST_CASE("a number may be one that is not finite where that is asked for", "[base][text]") {
  CHECK(std::isnan(to_any_number("nan").value_or(0)));
  CHECK(to_any_number("-inf") == -std::numeric_limits<double>::infinity());
  CHECK(to_any_number("+2.5") == 2.5);
  for (const char* text : {"", "nan1", "+-inf", "1 "}) {
    INFO(text);
    CHECK_FALSE(to_any_number(text));
  }
}

TEST_CASE("a whole number has no point, no spaces around it and fits 64 bits", "[base][text]") {
  CHECK(to_whole_number("1403636579763555584") == 1403636579763555584LL);  // EuRoC's nanoseconds
  CHECK(to_whole_number("-12") == -12);
  CHECK(to_whole_number("007") == 7);
  CHECK(to_whole_number("+1") == 1);
  for (const char* text : {"", "1.0", " 1", "1 ", "+-1", "+", "9223372036854775808", "x"}) {
    INFO(text);
    CHECK_FALSE(to_whole_number(text));
  }
}

TEST_CASE("numbers are separated by spaces, commas, semicolons and brackets", "[base][text]") {
  CHECK(to_numbers("[1, 2;3]\t4\r\n") == std::vector<double>{1, 2, 3, 4});
  CHECK(to_numbers(" ") == std::vector<double>{});
  CHECK_FALSE(to_numbers("1 2 m"));
}

TEST_CASE("lines of a file come without comments, line ends and empty lines", "[base][text]") {
  const test::ScratchFolder folder("text_numbers");
  test::write_bytes(folder / "a.txt", "# all comment\n1 2 # and a word\r\n\n  \n3\n");
  CHECK(read_lines(folder / "a.txt") == std::vector<std::string>{"1 2", "3"});
  CHECK_FALSE(read_lines(folder / "none.txt"));
  CHECK(is_image_side(640));
  for (const double side : {0.0, 640.5, 16385.0, -1.0}) CHECK_FALSE(is_image_side(side));
}

}  // namespace
}  // namespace palpable

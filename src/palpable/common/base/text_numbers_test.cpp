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

TEST_CASE("decimal commas are not taken for two numbers, and lists by commas are lists",
          "[base][text]") {
  for (const char* text : {"0,5 1,25", "3;0,5;-1,25", "1311870427,644555 0,000602 1", "1\t0,5\t2",
                           "525,0 525,0 319,5 239,5", "1e3 0,5"}) {
    INFO(text);
    CHECK(has_decimal_commas(text));
    CHECK_FALSE(to_numbers(text));
  }
  for (const char* text :
       {"0.5 1.25", "1,2,3", "1, 2, 3", "[1,0,0;0,1,0]", "[1, 0, 0, 1]", "0,0.04,0.42,0,0,0", "5",
        "1,5", "1,2.5 3,4.5", "a 1,5", "1403636579763555584,0.1,0.2", ""}) {
    INFO(text);
    CHECK_FALSE(has_decimal_commas(text));
  }
  CHECK(to_numbers("1, 2, 3") == std::vector<double>{1, 2, 3});
}

TEST_CASE("lines of a file come without comments, line ends and empty lines", "[base][text]") {
  const test::ScratchFolder folder("text_numbers");
  test::write_bytes(folder / "a.txt", "# all comment\n1 2 # and a word\r\n\n  \n3\n");
  CHECK(value_or_throw(read_lines(folder / "a.txt")) == std::vector<std::string>{"1 2", "3"});
  CHECK(read_lines(folder / "none.txt").problem().message == "no such file");
  test::write_bytes(folder / "b.txt",
                    "\xef\xbb\xbf"
                    "1 2\r3\r");  // a mark, and lone returns
  CHECK(value_or_throw(read_lines(folder / "b.txt")) == std::vector<std::string>{"1 2", "3"});
  CHECK(is_image_side(640));
  for (const double side : {0.0, 640.5, 16385.0, -1.0}) CHECK_FALSE(is_image_side(side));
}

TEST_CASE("a number is written with as few digits as tell it", "[base][text]") {
  CHECK(number_text(60e3) == "6e+04");
  CHECK(number_text(60001) == "60001");
  CHECK(number_text(0.4) == "0.4");
  CHECK(number_text(1.1 * 1e3) == "1100");  // 1100.0000000000002
  CHECK(number_text(-2.5e-7) == "-2.5e-07");
  CHECK(number_text(0) == "0");
  CHECK(number_text(1.0 / 3.0) == "0.333333333");
  CHECK(number_text(0.4999999999) == "0.5");
  CHECK(number_text(0.4999999999, 1e-14) == "0.4999999999");
}

}  // namespace
}  // namespace palpable

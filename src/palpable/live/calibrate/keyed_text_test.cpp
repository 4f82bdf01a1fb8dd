#include "palpable/live/calibrate/keyed_text.h"

#include "tests/support/test.h"

#include <string>
#include <vector>

namespace palpable {
namespace {

using Numbers = std::vector<double>;

TEST_CASE("keys of nested maps, lists and blocks are found with or without %YAML",
          "[calibrate][keyed_text]") {
  const std::string text =
      "# a comment: with a colon\nwidth: 640 # px\n\"name\": 'left # eye'\n"
      "cam0:\n  T:\n  - [1, 0.5,\n     -2]\n  - - 3.0\n    - 4e-1\n  deep: {rows: 3, data: [7,8 ], "
      "in: {x: 1}}\n"
      "M1: !!opencv-matrix\n   rows: 1\n   data: [ 1., .5,\n       -2.5e+02 ]\nlast: 9\n";
  for (const std::string& head : {std::string(), std::string("%YAML:1.0\n---\n")}) {
    const KeyedText keys = value_or_throw(KeyedText::parse(head + text));
    CHECK(keys.number("width") == 640);
    CHECK(keys.word("name") == "left # eye");
    CHECK(keys.numbers("cam0.T") == Numbers{1, 0.5, -2, 3, 0.4});
    CHECK(keys.numbers("cam0.deep") == Numbers{7, 8});
    CHECK(keys.number("cam0.deep.rows") == 3);
    CHECK(keys.number("cam0.deep.in.x") == 1);
    CHECK(keys.numbers("M1") == Numbers{1, 0.5, -250});
    CHECK(keys.number("last") == 9);
    CHECK_FALSE(keys.numbers("name"));
    CHECK_FALSE(keys.numbers("cam1.T"));
    CHECK_FALSE(keys.has("a comment"));
    CHECK(keys.first_of({"none", "last", "width"}) == "last");
  }
}

TEST_CASE("JSON and OpenCV's XML give the same keys", "[calibrate][keyed_text]") {
  const KeyedText json = value_or_throw(KeyedText::parse(
      R"({"baseline": "-49.5", "rectified.0.fx": 970.5, "M": {"rows": 3, "data": [1, [2, 3]]}})"));
  CHECK(json.number("baseline") == -49.5);
  CHECK(json.number("rectified.0.fx") == 970.5);
  CHECK(json.numbers("M") == Numbers{1, 2, 3});
  CHECK(json.has("M"));
  const KeyedText xml = value_or_throw(KeyedText::parse(
      "<?xml version=\"1.0\"?>\n<opencv_storage>\n<M1 type_id=\"opencv-matrix\">\n"
      "  <rows>1</rows>\n  <data>\n    5. 0. -3.5e+02</data></M1>\n<w>640</w></opencv_storage>\n"));
  CHECK(xml.numbers("M1") == Numbers{5, 0, -350});
  CHECK(xml.number("M1.rows") == 1);
  CHECK(xml.number("w") == 640);
}

TEST_CASE("texts that must not be parsed are refused, and long keys take no memory",
          "[calibrate][keyed_text][refusal]") {
  CHECK_FALSE(KeyedText::parse(std::string(70000, '[')).ok());
  CHECK_FALSE(KeyedText::parse("{\"a\": ").ok());
  std::string text = std::string(300000, 'k') + ":\n";
  for (int i = 0; i < 50000; ++i) text += " a" + std::to_string(i) + ":\n";
  const KeyedText keys = value_or_throw(KeyedText::parse(text));
  std::size_t bytes = 0;
  for (const auto& [path, value] : keys.entries()) bytes += path.size() + value.size();
  CHECK(bytes < 10'000'000);  // 15 GB if each kept the key above it
}

TEST_CASE("decimal commas become points where they are no list's commas",
          "[calibrate][keyed_text]") {
  const auto same = [](const char* text) { CHECK(with_decimal_points(text) == text); };
  CHECK(with_decimal_points("%YAML:1.0\ndata: [ 5,34e+02, 0, -0,28 ]\nfx: 700,5\n") ==
        "%YAML:1.0\ndata: [ 5.34e+02, 0, -0.28 ]\nfx: 700.5\n");
  CHECK(with_decimal_points("a: [640,480]\nb: 0,5\n") == "a: [640,480]\nb: 0.5\n");
  CHECK(with_decimal_points("fx=699,35\n") == "fx=699.35\n");
  CHECK(with_decimal_points("{\"b\": \"-49,9\", \"w\": 640}") == "{\"b\": \"-49.9\", \"w\": 640}");
  same("a: [1,2,3]\nb: 0,5\n");            // lists without spaces
  same("a: [ 1.5, 2 ]\nb: [0,0, 0,0]\n");  // points elsewhere
  same("resolution: [640,480]\n");
  same("");
  same("1,");
}

}  // namespace
}  // namespace palpable

#include "palpable/common/base/json.h"

#include "palpable/common/base/error.h"
#include "tests/support/test.h"

#include <nlohmann/json.hpp>

#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace palpable {
namespace {

// One value of each kind, built in the same way for either class.
template <class Value>
Value one_of_each() {
  Value value;
  value["zebra"] = 1;
  value["null"] = nullptr;
  value["yes"] = true;
  value["negative"] = -7;
  value["large"] = std::numeric_limits<std::uint64_t>::max();
  value["tenth"] = 0.1;
  value["single"] = 0.1f;
  value["whole"] = 3.0;
  value["tiny"] = -1.25e-300;
  value["infinite"] = std::numeric_limits<double>::infinity();
  value["text"] = "a \"quoted\" line\nand \t \x01 \xc3\xa4";
  value["list"] = std::vector<double>{1, 0.5};
  value["empty"] = Value::array();
  value["no keys"] = Value::object();
  value["object"] = {{"b", 1}, {"a", {1, 2, 3}}, {"b", 4}};
  value["mixed"] = {"b", 1, {{"a", 2}}};
  value["texts"] = {"a", "b", "c"};
  value["rows"].push_back({1, "one"});
  value["rows"].push_back({2, nullptr});
  value["nested"]["deeper"]["deepest"] = 0;
  value["zebra"] = "again";
  value.update(Value{{"text", 2}, {"new", 3}});
  return value;
}

TEST_CASE("what is written is what nlohmann's library writes of the same values", "[base][json]") {
  const auto ours = one_of_each<Json>();
  const auto theirs = one_of_each<nlohmann::ordered_json>();
  CHECK(ours.dump() == theirs.dump());
  CHECK(ours.dump(2) == theirs.dump(2));
}

TEST_CASE("JSON values are read as what they are, and refused as anything else", "[base][json]") {
  const Json value = {
      {"n", 3}, {"x", 0.5}, {"text", "abc"}, {"list", {1, 2, "c"}}, {"no", nullptr}};
  CHECK(value["n"].get<int>() == 3);
  CHECK(value["n"].get<double>() == 3.0);
  CHECK(value["n"].is_integer());
  CHECK_FALSE(value["x"].is_integer());
  CHECK(value["text"].get<std::string>() == "abc");
  CHECK(value["list"][2].get<std::string>() == "c");
  CHECK(value["list"].size() == 3);
  CHECK(value["no"].is_null());
  CHECK(value.items().size() == 5);
  CHECK(value.contains("no"));
  CHECK_FALSE(value.contains("missing"));
  CHECK_THROWS_AS(value["missing"], Error);
  CHECK_THROWS_AS(value["list"][3], Error);
  CHECK_THROWS_AS(value["text"].get<double>(), Error);
  CHECK_THROWS_AS(value["x"].get<std::string>(), Error);
  CHECK(Json(std::optional<double>()).is_null());
  CHECK(Json(std::optional(0.25)).get<double>() == 0.25);
}

TEST_CASE("a reader that must not throw learns of a value of another kind", "[base][json]") {
  const auto value = one_of_each<Json>();
  REQUIRE(value.find("tenth") != nullptr);
  CHECK(value.find("tenth")->if_number() == 0.1);
  CHECK_FALSE(value.find("tenth")->if_whole());
  CHECK(value.find("missing") == nullptr);
  CHECK(Json(3).find("x") == nullptr);
  CHECK(Json(-3).if_whole() == -3);
  CHECK(Json(-3).if_number() == -3.0);
  CHECK_FALSE(Json(std::uint64_t{1} << 63).if_whole());
  CHECK(Json(std::uint64_t{1} << 63).if_number() == 9223372036854775808.0);
  CHECK_FALSE(Json(true).if_number());
  CHECK(Json(true).if_text() == nullptr);
  CHECK(*Json("abc").if_text() == "abc");
  CHECK(Json::array().is_array());
  CHECK_FALSE(Json::array().is_object());
}

TEST_CASE("what was written is read again, numbers to the bit", "[base][json]") {
  auto value = one_of_each<Json>();
  value["infinite"] = nullptr;  // as which it is written
  for (const double x : {0.1, 1.0 / 3, -2.2250738585072014e-308, 1.7976931348623157e308, 5e-324}) {
    value["numbers"].push_back(x);
  }
  const std::string text = value.dump();
  const Result<Json> read = Json::parse(text);
  REQUIRE(read.ok());
  CHECK(read.value().dump() == text);
  CHECK(read.value()["numbers"][1].get<double>() == 1.0 / 3);
  CHECK(read.value()["large"].is_integer());
}

TEST_CASE("a text that is no JSON, or nested without end, is refused", "[base][json][errors]") {
  for (const char* text : {"", "{", "{\"a\": }", "[1, 2", "nul", "1e400e"}) {
    INFO(text);
    CHECK_FALSE(Json::parse(text).ok());
  }
  CHECK_FALSE(Json::parse(std::string(100'000, '[') + std::string(100'000, ']')).ok());
}

}  // namespace
}  // namespace palpable

#include "palpable/common/web_file/web_file.h"

#include "palpable/common/base/error.h"
#include "palpable/common/base/json.h"
#include "tests/support/as_body_file.h"
#include "tests/support/bodies.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/some_touch_tables.h"
#include "tests/support/test.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using test::ScratchFolder;

ReducedBody web_ball() {
  ReducedBody body = test::pressed_ball(0.05, 0.01, 1);
  body.method = "pgd";
  body.provenance.loads = "6 sites of \"2 N\"";
  body.provenance.sites_reached = 5;
  body.error = {1e-4, 2e-3, 3e-4, -0.0, 1e-5, 1.0 / 3.0, 0.26};
  ErrorCourse course{Eigen::Vector3i(1, 2, 5), Eigen::Vector3d(0.1, 0.02, 0.003),
                     Eigen::MatrixXf(6 * 4, 3)};
  for (Eigen::Index k = 0; k < course.snapshots.size(); ++k) {
    course.snapshots.data()[k] = 1e-3f * static_cast<float>(k);
  }
  body.error.displacement_course = course;
  body.error.von_mises_course = course;
  body.error.held_out = HeldOutRecord{Eigen::Vector2d(0.25, 0.75), Eigen::MatrixXf::Ones(2, 6),
                                      3e-4, 2 * Eigen::MatrixXf::Ones(2, 6)};
  return body;
}

TouchableBody touched_ball(int regions = 3) {
  ReducedBody body = web_ball();
  TouchTables tables = test::some_touch_tables(body.surface, regions);
  return {std::move(body), std::move(tables)};
}

// A fine ball, carried by the skin of a coarser one.
TouchableBody carried_ball() {
  ReducedBody coarse = web_ball();
  TouchTables tables = test::some_touch_tables(coarse.surface);
  tables.coarse = CoarseSkin{coarse.surface, coarse.fixed};
  tables.held_out[1].unscaled_error.reset();
  tables.vibration = test::some_vibration(tables.shell.nodes());
  return {test::pressed_ball(0.05, 0.01, 2), std::move(tables)};
}

// One whose energy is known in four modes.
TouchableBody modal_ball() {
  ReducedBody body = test::with_several(web_ball());
  ModalTables tables{test::some_touch_tables(body.surface, 0).shell, Eigen::MatrixXf(3, 4), 1.4e-5,
                     0.012};
  tables.inner_modes << 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, -0.5f;
  return {std::move(body), std::nullopt, std::move(tables)};
}

Result<TouchableBody> read_bytes(const std::string& bytes) {
  return read_web_file(std::as_bytes(std::span(bytes)));
}

std::string refusal(const std::string& bytes) {
  const Result<TouchableBody> read = read_bytes(bytes);
  return read.ok() ? "(read)" : read.problem().message;
}

std::uint64_t header_size(const std::string& bytes) {
  std::uint64_t size = 0;
  std::memcpy(&size, bytes.data() + 24, sizeof size);
  return size;
}

Json header_of(const std::string& bytes) {
  return value_or_throw(Json::parse(std::string_view(bytes).substr(32, header_size(bytes))));
}

// The file with another header, checksum and all.
std::string with_header(const std::string& bytes, std::string header) {
  const std::uint64_t before = header_size(bytes);
  header.resize((header.size() + 15) / 16 * 16, ' ');
  const std::uint64_t size = header.size();
  std::string changed = bytes.substr(0, 24);
  changed.append(reinterpret_cast<const char*>(&size), sizeof size);
  return with_web_checksum(changed + header + bytes.substr(32 + before));
}

// Where in the file an array begins. @throws Error if there is none of this name
std::size_t place_of(const std::string& bytes, std::string_view name) {
  const Json header = header_of(bytes);
  for (const Json& array : std::as_const(header)["arrays"]) {
    if (array["name"].get<std::string>() == name) {
      return 32 + header_size(bytes) + static_cast<std::size_t>(array["offset"].get<int>());
    }
  }
  throw Error("no such array");
}

// The file with one number of an array replaced, checksum and all.
template <class T>
std::string with_number(std::string bytes, std::string_view array, std::size_t index, T number) {
  std::memcpy(bytes.data() + place_of(bytes, array) + index * sizeof(T), &number, sizeof number);
  return with_web_checksum(std::move(bytes));
}

// The file with one word of its header replaced.
std::string with_word(const std::string& bytes, const std::string& word, const std::string& by) {
  std::string header = header_of(bytes).dump();
  const std::size_t at = header.find(word);
  if (at == std::string::npos) throw Error("no " + word);
  return with_header(bytes, header.replace(at, word.size(), by));
}

TEST_CASE("a delivery file restores every value of a body to the bit", "[web_file]") {
  const ScratchFolder folder("web_file");
  for (const TouchableBody& body :
       {TouchableBody(web_ball()), touched_ball(0), touched_ball(), modal_ball()}) {
    const std::string bytes = web_file_bytes(body);
    const Result<TouchableBody> again = read_bytes(bytes);
    if (!again.ok()) FAIL(again.problem().message);
    CHECK((test::as_body_file(again.value(), folder) == test::as_body_file(body, folder)));
    CHECK((web_file_bytes(again.value()) == bytes));
    CHECK(std::signbit(again.value().body.error.stress_worst));
  }
}

TEST_CASE("a coarser skin and touches without an indicator come back", "[web_file]") {
  const TouchableBody body = carried_ball();
  const Result<TouchableBody> again = read_bytes(web_file_bytes(body));
  if (!again.ok()) FAIL(again.problem().message);
  const TouchTables& tables = *again.value().touch;
  REQUIRE(tables.coarse.has_value());
  CHECK(tables.coarse->surface.vertices == body.touch->coarse->surface.vertices);
  CHECK(tables.coarse->surface.triangles == body.touch->coarse->surface.triangles);
  CHECK(tables.coarse->fixed == body.touch->coarse->fixed);
  REQUIRE(tables.vibration.has_value());
  CHECK(tables.vibration->omega == body.touch->vibration->omega);
  CHECK(tables.vibration->shapes == body.touch->vibration->shapes);
  CHECK(tables.vibration->mass == body.touch->vibration->mass);
  CHECK(tables.held_out[0].unscaled_error == body.touch->held_out[0].unscaled_error);
  CHECK_FALSE(tables.held_out[1].unscaled_error.has_value());
}

TEST_CASE("the volume is left out, and a body with free parameters is refused", "[web_file]") {
  const ReducedBody further = test::with_further(web_ball());
  CHECK_THROWS_WITH(web_file_bytes(further), Catch::Contains("settle"));
  ReducedBody one = settled(further).value();
  one.error = {};
  REQUIRE(one.volume.has_value());
  CHECK_FALSE(read_bytes(web_file_bytes(one)).value().body.volume.has_value());
}

TEST_CASE("arrays lie on multiples of 16 bytes, and tables are the numbers of memory",
          "[web_file]") {
  const TouchableBody body = touched_ball();
  const std::string bytes = web_file_bytes(body);
  const Json header = header_of(bytes);
  CHECK(std::as_const(header)["byte_order"].get<std::string>() == "little");
  CHECK(std::as_const(header)["name"].get<std::string>() == "ball");
  CHECK(std::as_const(header)["arrays"].size() > 60);
  for (const Json& array : std::as_const(header)["arrays"]) {
    CHECK(array["offset"].get<int>() % 16 == 0);
  }
  const std::vector<std::int16_t>& near = body.touch->compliance.near;
  const std::size_t size = near.size() * sizeof near[0];
  CHECK(std::memcmp(near.data(), bytes.data() + place_of(bytes, "touch/compliance/near"), size) ==
        0);
}

TEST_CASE("a body that breaks a rule is not written over a good file", "[web_file][errors]") {
  const ScratchFolder folder("web_file");
  const fs::path path = folder / "ball.palpweb";
  write_web_file(path, touched_ball());
  const std::string good = test::file_bytes(path);
  CHECK((good == web_file_bytes(touched_ball())));
  const std::vector<std::pair<std::string, std::function<void(TouchableBody&)>>> faults{
      {"not watertight", [](auto& b) { b.body.surface.triangles.col(0).setZero(); }},
      {"no load", [](auto& b) { b.body.sites[1].full_load = 0; }},
      {"'fixed' does not have", [](auto& b) { b.body.fixed.pop_back(); }},
      {"one weight per vertex", [](auto& b) { b.body.sites[0].weights.pop_back(); }},
      {"'error/stress_pooled' is not a number",
       [](auto& b) { b.body.error.stress_pooled = std::numeric_limits<double>::quiet_NaN(); }},
      {"not of the surface's 42 vertices",
       [](auto& b) { b.body.displacement = test::pressed_ball(0.05, 0.01, 0).displacement; }},
      {"region 1 is wrong in its middle", [](auto& b) { b.touch->regions[1].vertex = 4711; }},
  };
  for (const auto& [expected, spoil] : faults) {
    TouchableBody body = touched_ball();
    spoil(body);
    CHECK_THROWS_WITH(write_web_file(path, body),
                      Catch::Contains(path.string()) && Catch::Contains(expected));
    CHECK((test::file_bytes(path) == good));
  }
}

TEST_CASE("a delivery file that is cut short is refused at every length", "[web_file][errors]") {
  const std::string good = web_file_bytes(touched_ball());
  for (std::size_t n = 0; n < good.size(); n += n < 64 ? 1 : 1 + good.size() / 300) {
    // With a checksum for the bytes that are left, too, so that each length is judged by itself.
    for (const std::string& cut : {good.substr(0, n), with_web_checksum(good.substr(0, n))}) {
      const Result<TouchableBody> read = read_bytes(cut);
      if (read.ok()) FAIL("read a file cut at byte " << n << " of " << good.size());
      CHECK(read.problem().message.find('\n') == std::string::npos);
    }
  }
  CHECK_THAT(refusal(good.substr(0, good.size() - 1)), Catch::Contains("is cut short"));
  CHECK_THAT(refusal(good + " "), Catch::Contains("is damaged"));
}

TEST_CASE("a delivery file with one changed byte is refused", "[web_file][errors]") {
  const std::string good = web_file_bytes(touched_ball());
  for (unsigned seed = 0; seed < 300; ++seed) {
    auto random = test::random_case(seed);
    std::string damaged = good;
    damaged[random() % (seed % 3 == 0 ? 64 : good.size())] ^= static_cast<char>(1 + random() % 255);
    if (read_bytes(damaged).ok()) FAIL("read a damaged file, seed " << seed);
  }
}

TEST_CASE("numbers of arrays that do not fit each other are named", "[web_file][errors]") {
  const std::string good = web_file_bytes(touched_ball());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<std::pair<std::string, std::string>> faults{
      {"watertight", with_number(good, "surface/triangles", 4, 4711)},
      {"a vertex is not a number", with_number(good, "surface/vertices", 7, double{NAN})},
      {"a mode of 'displacement'", with_number(good, "displacement/modes", 9, nan)},
      {"the samples of axis 'level'", with_number(good, "stress/level/samples", 1, 0.9)},
      {"'sites/patch_begin' has a size", with_number(good, "sites/patch_begin", 6, 4711)},
      {"'sites/patch_begin' has a size", with_number(good, "sites/patch_begin", 1, -1)},
      {"patch off the surface", with_number(good, "sites/patch", 3, -1)},
      {"between samples the press", with_number(good, "sites/level_slope", 1, -1.0)},
      {"touch: the compliance", with_number(good, "touch/compliance/first", 1, -5)},
      {"touch: the compliance", with_number(good, "touch/compliance/neighbours", 0, 1 << 30)},
      {"touch: the compliance is wrong in a factor",
       with_number(good, "touch/compliance/near_scale", 0, nan)},
      {"region 0 is wrong in its list", with_number(good, "touch/region_0000/vertices", 0, -1)},
      {"touch: the shell", with_number(good, "touch/shell/elements", 5, 4711)},
      {"touch: the vibration modes",
       with_number(web_file_bytes(carried_ball()), "touch/vibration/omega", 1, -1.0)},
      {"touch: the held-out touches", with_number(good, "touch/held_out/things", 1, 99)},
      {"'displacement_course' do not increase",
       with_number(good, "error/displacement_course/modes", 1, 1)},
  };
  for (const auto& [expected, bytes] : faults)
    CHECK_THAT(refusal(bytes), Catch::Contains(expected));
  const std::string modal = web_file_bytes(modal_ball());
  CHECK_THAT(refusal(with_number(modal, "several_loads/quadratic", 0, -1.0)),
             Catch::Contains("positive definite"));
  CHECK_THAT(refusal(with_number(modal, "touch_modes/inner_modes", 2, nan)),
             Catch::Contains("touch_modes: a mode of inner nodes"));
}

TEST_CASE("a header that does not describe the file is refused", "[web_file][errors]") {
  const std::string good = web_file_bytes(touched_ball());
  const std::string list = "\"shape\":[42,3],\"offset\":";
  const std::string offset = header_of(good).dump();
  const std::size_t at = offset.find(list) + list.size();
  const std::string number = list + offset.substr(at, offset.find('}', at) - at);
  const std::vector<std::pair<std::string, std::string>> faults{
      {"version 2", with_word(good, "\"version\":1", "\"version\":2")},
      {"not little-endian", with_word(good, "little", "big")},
      {"no delivery file", with_word(good, "palpable web body", "palpable film")},
      {"'touch/shell/first' is missing", with_word(good, "touch/shell/first", "touch/shell/furst")},
      {"twice", with_word(good, "touch/shell/points", "touch/shell/first")},
      {"'surface/vertices' does not lie in the file", with_word(good, number, list + "8")},
      {"'surface/vertices' does not lie in the file", with_word(good, number, list + "-16")},
      {"'surface/vertices' does not lie in the file",
       with_word(good, number, list + "1152921504606846976")},
      {"'surface/vertices' does not lie in the file",
       with_word(good, "\"shape\":[42,3]", "\"shape\":[200000000,200000000]")},
      {"'surface/vertices' does not lie in the file",
       with_word(good, "\"shape\":[42,3]", "\"shape\":[42,-3]")},
      {"'surface/vertices' does not lie in the file",
       with_word(good, "\"shape\":[42,3]", "\"shape\":[42,1,3]")},
      {"'surface/vertices' has a size", with_word(good, "\"shape\":[42,3]", "\"shape\":[63,2]")},
      {"'surface/vertices' is of float64 in 1",
       with_word(good, "\"shape\":[42,3]", "\"shape\":[126]")},
      {"does not lie in the file", with_word(good, "\"int16\"", "\"int17\"")},
      {"'touch/regions' is missing or out of range",
       with_word(good, "\"touch/regions\":3", "\"touch/regions\":2000000000")},
      {"'touch/regions' is missing or out of range",
       with_word(good, "\"touch/regions\":3", "\"touch/regions\":\"3\"")},
      {"'touch/region_0003/", with_word(good, "\"touch/regions\":3", "\"touch/regions\":4")},
      {"'touch/region_0000/quartic' has a size",
       with_word(good, "\"touch/region_0000/leading\":5", "\"touch/region_0000/leading\":-5")},
      {"law", with_word(good, "neo-hookean", "neo-hookeon")},
      {"header", with_header(good, "{\"format\": ")},
      {"header", with_header(good, std::string(100, '['))},
      {"no delivery file", with_header(good, "[]")},
  };
  for (const auto& [expected, bytes] : faults) {
    CHECK_THAT(refusal(bytes), Catch::Contains(expected) && !Catch::Contains("\n"));
  }
}

TEST_CASE("a delivery file may lie anywhere in memory", "[web_file]") {
  const std::string bytes = web_file_bytes(touched_ball());
  for (std::size_t shift = 1; shift < 8; ++shift) {
    const std::string moved = std::string(shift, '\0') + bytes;
    const auto span = std::as_bytes(std::span(moved)).subspan(shift);
    REQUIRE(read_web_file(span).ok());
  }
}

TEST_CASE("a file on disk is read by its name", "[web_file][files]") {
  const ScratchFolder folder("web_file");
  const fs::path path = folder / "ball.palpweb";
  CHECK(load_web_file(path).problem().message == path.string() + ": no such file");
  write_web_file(path, touched_ball());
  REQUIRE(load_web_file(path).ok());
  std::string bytes = test::file_bytes(path);
  bytes.back() ^= 1;
  test::write_bytes(path, bytes);
  CHECK_THAT(load_web_file(path).problem().message,
             Catch::StartsWith(path.string() + ": is damaged"));
  test::write_bytes(path, "solid ball\n");
  CHECK_THAT(load_web_file(path).problem().message,
             Catch::Contains("is no delivery file of Palpable"));
}

}  // namespace
}  // namespace palpable

#include "palpable/reduced/body_file.h"

#include "tests/support/bodies.h"
#include "tests/support/test.h"

#include <fmt/format.h>

#include <fstream>
#include <functional>
#include <iterator>
#include <unistd.h>

namespace palpable {
namespace {

namespace fs = std::filesystem;

// A folder of its own for each case, gone afterwards.
class Folder {
 public:
  Folder() : path_(fs::temp_directory_path() / fmt::format("palpable_body_file_{}", ::getpid())) {
    fs::create_directories(path_);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() { fs::remove_all(path_); }
  [[nodiscard]] fs::path operator/(const char* name) const { return path_ / name; }

 private:
  fs::path path_;
};

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void write_bytes(const fs::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary)
      .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

ReducedBody small_ball() { return test::pressed_ball(0.05, 0.01, 1); }

TEST_CASE("a body that was written is read back the same", "[reduced][files]") {
  const Folder folder;
  const ReducedBody body = small_ball();
  write_body_file(folder / "ball.palpable", body);
  const Result<ReducedBody> result = read_body_file(folder / "ball.palpable");
  REQUIRE(result.ok());
  const ReducedBody& again = result.value();
  CHECK(again.name == body.name);
  CHECK(again.material == body.material);
  CHECK(again.surface.vertices == body.surface.vertices);
  CHECK(again.surface.triangles == body.surface.triangles);
  CHECK(again.fixed == body.fixed);
  CHECK(again.press_depth == body.press_depth);
  CHECK(again.largest_von_mises == body.largest_von_mises);
  CHECK(again.provenance == body.provenance);
  REQUIRE(again.sites.size() == body.sites.size());
  for (std::size_t s = 0; s < body.sites.size(); ++s) {
    CHECK(again.sites[s].vertex == body.sites[s].vertex);
    CHECK(again.sites[s].patch == body.sites[s].patch);
    CHECK(again.sites[s].weights == body.sites[s].weights);
    CHECK(again.sites[s].direction == body.sites[s].direction);
    CHECK(again.sites[s].full_load == body.sites[s].full_load);
  }
  for (const auto field : {&ReducedBody::displacement, &ReducedBody::stress}) {
    CHECK((again.*field).modes() == (body.*field).modes());
    for (std::size_t j = 0; j < 2; ++j) {
      CHECK((again.*field).axes()[j].name == (body.*field).axes()[j].name);
      CHECK((again.*field).axes()[j].samples == (body.*field).axes()[j].samples);
      CHECK((again.*field).axes()[j].functions == (body.*field).axes()[j].functions);
      CHECK((again.*field).axes()[j].between == (body.*field).axes()[j].between);
    }
  }
}

TEST_CASE("the same body gives the same bytes", "[reduced][files]") {
  const Folder folder;
  write_body_file(folder / "a.palpable", small_ball());
  write_body_file(folder / "b.palpable", small_ball());
  CHECK(bytes_of(folder / "a.palpable") == bytes_of(folder / "b.palpable"));
}

TEST_CASE("a file that is missing, foreign or of another version says so", "[reduced][errors]") {
  const Folder folder;
  CHECK(read_body_file(folder / "none.palpable").problem().message.find("no such body file") !=
        std::string::npos);
  write_bytes(folder / "text.palpable", "this is not a body\n");
  CHECK(read_body_file(folder / "text.palpable").problem().message.find("not a body file") !=
        std::string::npos);
  write_bytes(folder / "empty.palpable", "");
  CHECK_FALSE(read_body_file(folder / "empty.palpable").ok());
}

TEST_CASE("a body that breaks a rule of its own is not written over a good one",
          "[reduced][errors]") {
  const Folder folder;
  const fs::path path = folder / "ball.palpable";
  write_body_file(path, small_ball());
  const std::string good = bytes_of(path);

  const std::vector<std::pair<std::string, std::function<void(ReducedBody&)>>> faults{
      {"not watertight",
       [](auto& b) { b.surface.triangles = b.surface.triangles.leftCols(70).eval(); }},
      {"'fixed' does not have", [](auto& b) { b.fixed.pop_back(); }},
      {"one weight per vertex", [](auto& b) { b.sites[0].weights.pop_back(); }},
      {"no load", [](auto& b) { b.sites[1].full_load = 0; }},
      {"unit vector", [](auto& b) { b.sites[2].direction *= 2; }},
      {"off the surface", [](auto& b) { b.sites[3].patch[1] = 4711; }},
      {"its own patch", [](auto& b) { b.sites[4].vertex = b.sites[4].patch[1]; }},
      {"sum to 1", [](auto& b) { b.sites[5].weights[0] += 0.5f; }},
      {"does not grow", [](auto& b) { b.press_depth(2, 3) = 0; }},
      {"not a stress", [](auto& b) { b.largest_von_mises = NAN; }},
      {"no site",
       [](auto& b) {
         b.sites.clear();
         b.press_depth.resize(5, 0);
       }},
  };
  for (const auto& [expected, spoil] : faults) {
    ReducedBody body = small_ball();
    spoil(body);
    std::string message = "(written)";
    try {
      write_body_file(path, body);
    } catch (const Error& error) { message = error.what(); }
    INFO(expected << " <- " << message);
    CHECK(message.find(expected) != std::string::npos);
    CHECK(bytes_of(path) == good);
    CHECK_FALSE(fs::exists(folder / "ball.palpable.part"));
  }
}

TEST_CASE("a folder that does not exist is a clear error", "[reduced][errors]") {
  CHECK_THROWS_WITH(write_body_file("/nowhere/ball.palpable", small_ball()),
                    Catch::Contains("/nowhere/ball.palpable: cannot be created"));
}

TEST_CASE("a full disk is a clear error and leaves the old file", "[reduced][errors]") {
  if (!fs::exists("/dev/full")) PALPABLE_SKIP("/dev/full is not there");
  const Folder folder;
  fs::create_symlink("/dev/full", folder / "ball.palpable.part");
  CHECK_THROWS_AS(write_body_file(folder / "ball.palpable", small_ball()), Error);
  CHECK_FALSE(fs::exists(folder / "ball.palpable"));
}

// What reading promises: a good body or a problem, whatever the bytes.
TEST_CASE("a truncated body file is refused at every length", "[reduced][fuzz]") {
  const Folder folder;
  const fs::path path = folder / "ball.palpable";
  write_body_file(path, small_ball());
  const std::string good = bytes_of(path);
  for (std::size_t n = 0; n < good.size(); n += 1 + good.size() / 200) {
    write_bytes(path, good.substr(0, n));
    if (read_body_file(path).ok()) FAIL("read a file cut at byte " << n << " of " << good.size());
  }
}

TEST_CASE("a body file with one changed byte is refused", "[reduced][fuzz]") {
  const Folder folder;
  const fs::path path = folder / "ball.palpable";
  write_body_file(path, small_ball());
  const std::string good = bytes_of(path);
  for (unsigned seed = 0; seed < 500; ++seed) {
    auto random = test::random_case(seed);
    std::string damaged = good;
    // Half of the hits go to the first kilobytes, where the structure lies.
    const std::size_t range =
        seed % 2 == 0 ? good.size() : std::min<std::size_t>(good.size(), 4096);
    damaged[random() % range] ^= static_cast<char>(1 + random() % 255);
    write_bytes(path, damaged);
    if (read_body_file(path).ok()) FAIL("read a damaged file, seed " << seed);
  }
}

TEST_CASE("a file of another layout is refused by its version", "[reduced][errors]") {
  const Folder folder;
  write_bytes(folder / "new.palpable", "palpable body file, layout 99\nwhatever comes then");
  CHECK(read_body_file(folder / "new.palpable").problem().message.find("layout version '99'") !=
        std::string::npos);
}

}  // namespace
}  // namespace palpable

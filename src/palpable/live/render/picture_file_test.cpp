#include "palpable/live/render/picture_file.h"

#include "tests/support/test.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <unistd.h>

using namespace palpable;

namespace {

/// A temporary folder that is deleted at the end.
class Folder {
 public:
  explicit Folder(const char* name)
      : path_(std::filesystem::temp_directory_path() /
              (std::string("palpable_picture_") + name + std::to_string(::getpid()))) {
    std::filesystem::create_directories(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  [[nodiscard]] std::filesystem::path operator/(const char* name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

ColorImage some_picture(int width, int height) {
  ColorImage picture(width, height);
  auto random = test::random_case(7);
  std::uniform_int_distribution<int> byte(0, 255);
  const auto next = [&] { return static_cast<std::uint8_t>(byte(random)); };
  for (Rgb& pixel : picture) pixel = {next(), next(), next()};
  return picture;
}

}  // namespace

TEST_CASE("a picture comes back from its PNG as it was", "[render]") {
  const Folder folder("round");
  const ColorImage picture = some_picture(31, 17);
  write_png(folder / "a.png", picture);
  const Result<ColorImage> back = read_png(folder / "a.png");
  REQUIRE(back.ok());
  CHECK(back.value() == picture);
}

TEST_CASE("a grey PNG reads as three equal channels", "[render]") {
  const Folder folder("grey");
  GrayImage grey(5, 3);
  for (int i = 0; i < 15; ++i) grey.data()[i] = static_cast<std::uint8_t>(17 * i);
  write_png(folder / "g.png", grey);
  const Result<ColorImage> back = read_png(folder / "g.png");
  REQUIRE(back.ok());
  CHECK(back.value()(4, 2) == Rgb{238, 238, 238});
  CHECK(back.value()(1, 0) == Rgb{17, 17, 17});
}

TEST_CASE("what is not a PNG, or not all of one, is refused by name", "[render]") {
  const Folder folder("bad");
  const auto refused = [&](const std::filesystem::path& path) {
    const Result<ColorImage> result = read_png(path);
    REQUIRE_FALSE(result.ok());
    INFO(result.problem().message);
    CHECK(result.problem().message.find(path.filename().string()) != std::string::npos);
  };
  refused(folder / "missing.png");
  std::ofstream(folder / "text.png") << "this is text";
  refused(folder / "text.png");
  write_png(folder / "whole.png", some_picture(31, 17));
  std::ifstream in(folder / "whole.png", std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(in)), {});
  for (const std::size_t kept : {std::size_t{0}, std::size_t{20}, bytes.size() / 2}) {
    std::ofstream(folder / "part.png", std::ios::binary) << bytes.substr(0, kept);
    refused(folder / "part.png");
  }
}

TEST_CASE("a picture that cannot be written says where and why", "[render]") {
  CHECK_THROWS_WITH(
      write_png("/nonexistent/folder/a.png", some_picture(3, 3)),
      Catch::Contains("/nonexistent/folder/a.png") && Catch::Contains("No such file"));
  const Folder folder("full");
  std::filesystem::create_symlink("/dev/full", folder / "a.png");
  CHECK_THROWS_WITH(write_png(folder / "a.png", some_picture(3, 3)),
                    Catch::EndsWith("a.png: cannot be written: No space left on device"));
}

#include "palpable/common/base/own_files.h"

#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <array>
#include <filesystem>
#include <string_view>

namespace palpable {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 4> kOfRun{"timing.csv", "depth/#.png", "meshes/#.ply",
                                                 "meshes/*/rest.ply"};

TEST_CASE("only files of the program's own names are found and removed", "[base][refusal]") {
  const test::ScratchFolder folder("own_files");
  const fs::path out = folder / "out";
  CHECK(own_files(out, kOfRun).empty());
  CHECK_NOTHROW(remove_own_files(out, kOfRun));
  for (const char* own : {"timing.csv", "depth/000000.png", "depth/1000000.png",
                          "meshes/000007.ply", "meshes/post/rest.ply"}) {
    test::write_bytes(out / own, "ours");
  }
  for (const char* other : {"notes.txt", "depth/notes.txt", "depth/17.png", "depth/00000a.png",
                            "depth/000000.png.bak", "meshes/post/mine.ply", "more/000000.png"}) {
    test::write_bytes(out / other, "mine");
  }
  fs::create_directories(out / "depth/000003.png");  // somebody's folder
  CHECK(own_files(out, kOfRun) ==
        std::vector<fs::path>{out / "timing.csv", out / "depth/000000.png",
                              out / "depth/1000000.png", out / "meshes/000007.ply",
                              out / "meshes/post/rest.ply"});
  remove_own_files(out, kOfRun);
  CHECK(own_files(out, kOfRun).empty());
  for (const char* other : {"notes.txt", "depth/notes.txt", "depth/17.png", "depth/00000a.png",
                            "depth/000000.png.bak", "meshes/post/mine.ply", "more/000000.png"}) {
    INFO(other);
    CHECK(test::file_bytes(out / other) == "mine");
  }
  CHECK(fs::is_directory(out / "depth/000003.png"));
}

TEST_CASE("folders that have become empty go, links to folders stay with what they hold",
          "[base]") {
  const test::ScratchFolder folder("own_files_links");
  const fs::path out = folder / "out";
  test::write_bytes(folder / "disk/000000.png", "ours");
  test::write_bytes(out / "meshes/post/rest.ply", "ours");
  fs::create_directory_symlink(folder / "disk", out / "depth");
  remove_own_files(out, kOfRun);
  CHECK_FALSE(fs::exists(out / "meshes"));
  CHECK(fs::is_symlink(out / "depth"));
  CHECK(fs::exists(folder / "disk/000000.png"));
  CHECK(fs::is_directory(out));
}

}  // namespace
}  // namespace palpable

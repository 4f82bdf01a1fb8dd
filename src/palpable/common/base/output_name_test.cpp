#include "palpable/common/base/output_name.h"

#include "palpable/common/base/error.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <filesystem>

namespace palpable {
namespace {

using Catch::Matchers::Contains;

TEST_CASE("an output's name says what is written, or is refused with the endings that do",
          "[base][refusal]") {
  CHECK_NOTHROW(require_ending("out/x.vtu", {".vtu"}, "a VTK grid"));
  CHECK_NOTHROW(require_ending("x.yaml", {".yml", ".yaml"}, "a calibration"));
  CHECK_NOTHROW(require_ending("a.b.vtu", {".vtu"}, "a VTK grid"));
  CHECK_THROWS_WITH(require_ending("out/x.stl", {".vtu"}, "a VTK grid"),
                    "out/x.stl: what is written is a VTK grid, whose name ends in .vtu; call it "
                    "out/x.vtu");
  CHECK_THROWS_WITH(require_ending("x.json", {".yml", ".yaml"}, "a calibration"),
                    Contains("ends in .yml or .yaml; call it x.yml"));
  CHECK_THROWS_WITH(require_ending("bunny", {".palpable"}, "a body file"),
                    Contains("call it bunny.palpable"));
  // The number is part of the name.
  CHECK_THROWS_WITH(require_ending("nu_0.45", {".palpable"}, "a body file"),
                    Contains("call it nu_0.45.palpable"));
  CHECK_THROWS_WITH(require_ending("x.VTU", {".vtu"}, "a VTK grid"), Contains("x.VTU"));
  CHECK_THROWS_WITH(require_ending("", {".vtu"}, "a VTK grid"), Contains("is empty"));
  CHECK_THROWS_WITH(require_ending(".vtu", {".vtu"}, "a VTK grid"), Contains(".vtu: what"));
}

TEST_CASE("a folder may have any name but that of a file", "[base][refusal]") {
  const test::ScratchFolder folder("output_name");
  for (const char* name : {"out", "out/", "run.2", "bunny.snapshots", "2024.11.30", ".hidden"}) {
    INFO(name);
    CHECK_NOTHROW(require_folder_name(folder / name));
  }
  CHECK_THROWS_WITH(require_folder_name("a/x.npy"),
                    "a/x.npy: is the name of a file (.npy), and a folder is written; call it a/x");
  CHECK_THROWS_WITH(require_folder_name("film.mp4/"), Contains("call it film"));
  // Somebody's folder that has such a name is one.
  std::filesystem::create_directories(folder / "x.npy");
  CHECK_NOTHROW(require_folder_name(folder / "x.npy"));
}

}  // namespace
}  // namespace palpable

#include "palpable/common/geometry/mesh_file.h"
#include "palpable/common/geometry/surface_repair.h"
#include "tests/fuzz/fuzz_reader.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/surface_bytes.h"

#include <utility>

namespace palpable::fuzz {
namespace {

namespace fs = std::filesystem;

std::string read(const fs::path& /*folder*/, const fs::path& file) {
  return said(read_surface_file(file), [](const SurfaceMesh& surface) {
    (void)check_watertight(surface).describe();
    SurfaceMesh repaired = surface;
    (void)repair_surface(repaired).describe();
  });
}

}  // namespace

void add_surface_readers(std::vector<FuzzReader>& readers) {
  const auto add = [&](const char* name, std::vector<std::pair<std::string, std::string>> files) {
    readers.push_back({.name = name,
                       .write =
                           [files = std::move(files)](const fs::path& folder) {
                             std::vector<std::string> names;
                             for (const auto& [file, bytes] : files) {
                               test::write_bytes(folder / file, bytes);
                               names.push_back(file);
                             }
                             return names;
                           },
                       .read = read});
  };
  add("surface.stl", {{"text.stl", test::text_stl()}, {"binary.stl", test::binary_stl()}});
  add("surface.obj", {{"a.obj", test::kObj}});
  add("surface.3ds", {{"a.3ds", test::studio_3ds()}});
  add("surface.off", {{"a.off", test::kOff}});
  readers.push_back({.name = "surface.ply",
                     .write = [](const fs::path& folder) -> std::vector<std::string> {
                       test::write_bytes(folder / "text.ply", test::kPly);
                       test::write_bytes(folder / "big.ply", test::big_endian_ply());
                       write_ply(folder / "little.ply", sphere_surface({0, 0, 0}, 0.1, 1));
                       return {"text.ply", "big.ply", "little.ply"};
                     },
                     .read = read});
}

}  // namespace palpable::fuzz

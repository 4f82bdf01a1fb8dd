#include "palpable/common/base/npy_file.h"

#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <string>
#include <vector>

namespace palpable {
namespace {

namespace fs = std::filesystem;
using test::ScratchFolder;

void replace_in(const fs::path& path, const std::string& from, const std::string& to) {
  std::string bytes = test::file_bytes(path);
  const std::size_t at = bytes.find(from);
  REQUIRE(at != std::string::npos);
  test::write_bytes(path, bytes.replace(at, from.size(), to));
}

TEST_CASE("arrays of NumPy come back, in both orders and all types", "[base]") {
  const ScratchFolder folder("npy_file");
  const fs::path path = folder.path() / "a.npy";
  const std::vector<int> numbers{0, 1, 2, 3, 4, 5};
  write_npy(path, {2, 3}, std::span<const int>(numbers));
  CHECK(fs::file_size(path) == 128 + 24);  // values begin at a multiple of 64
  CHECK(read_npy(path).shape == std::vector<std::size_t>{2, 3});
  CHECK(read_npy(path).values == std::vector<double>{0, 1, 2, 3, 4, 5});
  replace_in(path, "'fortran_order': False", "'fortran_order': True ");
  CHECK(read_npy(path).values == std::vector<double>{0, 2, 4, 1, 3, 5});
  replace_in(path, "<i4", "<c8");
  CHECK_THROWS_WITH(read_npy(path), Catch::Contains("not floats or integers"));
  replace_in(path, "<c8", "<f8");
  CHECK_THROWS_WITH(read_npy(path), Catch::Contains("cut short"));
  test::write_bytes(path, "no array");
  CHECK_THROWS_WITH(read_npy(path), Catch::Contains("a.npy: not a file of NumPy"));
  const std::vector<double> odd{0.1};
  write_npy(path, {1}, std::span<const double>(odd));
  CHECK(read_npy(path).values == odd);
}

}  // namespace
}  // namespace palpable

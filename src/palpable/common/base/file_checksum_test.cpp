#include "palpable/common/base/file_checksum.h"

#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <string>

namespace palpable {
namespace {

TEST_CASE("a file's checksum changes with any of its bytes and with its length", "[base][hash]") {
  const test::ScratchFolder folder("file_checksum");
  const auto of = [&](const std::string& bytes) {
    test::write_bytes(folder / "a", bytes);
    return file_checksum(folder / "a").value();
  };
  std::string bytes(3'000'001, 'x');  // several pieces and a rest
  const std::uint64_t whole = of(bytes);
  CHECK(of(bytes) == whole);
  CHECK(of(bytes.substr(1)) != whole);
  for (const std::size_t at : {std::size_t{0}, std::size_t{1} << 20, bytes.size() - 1}) {
    std::string changed = bytes;
    changed[at] = 'y';
    CHECK(of(changed) != whole);
  }
  CHECK(of("") != whole);
}

TEST_CASE("a checksum of something that is not a file is refused", "[base][hash][errors]") {
  const test::ScratchFolder folder("no_checksum");
  CHECK(file_checksum(folder.path()).problem().message == "no such file");
  CHECK(file_checksum(folder / "none").problem().message == "no such file");
}

}  // namespace
}  // namespace palpable

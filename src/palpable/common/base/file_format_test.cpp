#include "palpable/common/base/file_format.h"

#include "palpable/common/base/error.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/test.h"

#include <fstream>
#include <string>
#include <utility>
#include <vector>

namespace palpable {
namespace {

using Catch::Matchers::Contains;

TEST_CASE("an output replaces a file of its own format, and no other", "[base]") {
  const test::ScratchFolder folder("file_format");
  const std::vector<std::pair<FileFormat, std::string>> kBeginnings{
      {FileFormat::kBody, "palpable body file, layout 1\n..."},
      {FileFormat::kHdf5, "\x89HDF\r\n\x1a\n..."},
      {FileFormat::kNpy, "\x93NUMPY.."},
      {FileFormat::kXml, "<?xml version=\"1.0\"?>"},
      {FileFormat::kXml, "\xEF\xBB\xBF\n<VTKFile>"},
      {FileFormat::kGmsh, "$MeshFormat\n4.1"},
      {FileFormat::kDeck, "** a comment\n*NODE\n"},
      {FileFormat::kRecording, "PALPREC\n...."},
      {FileFormat::kWebFile, "PALPWEB\n...."},
      {FileFormat::kHands, "{\"time\":0.000000,\"things\":[]}\n"}};
  const std::filesystem::path file = folder.path() / "mine";
  for (const auto& [format, text] : kBeginnings) {
    INFO(text);
    CHECK_NOTHROW(guard_format(file, format));  // none there
    for (const auto& [other, its_text] : kBeginnings) {
      std::ofstream(file, std::ios::binary) << its_text;
      if (other == format) {
        CHECK_NOTHROW(guard_format(file, format));
      } else {
        CHECK_THROWS_WITH(guard_format(file, format), Contains("mine: is there already and is no"));
      }
    }
    std::ofstream(file) << "my notes\n";
    CHECK_THROWS_WITH(guard_format(file, format), Contains("somebody's"));
    std::ofstream{file};  // empty: nothing is lost
    CHECK_NOTHROW(guard_format(file, format));
    std::filesystem::remove(file);
  }
}

}  // namespace
}  // namespace palpable

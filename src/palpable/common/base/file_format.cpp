#include "palpable/common/base/file_format.h"

#include "palpable/common/base/error.h"

#include <fmt/core.h>

#include <fstream>
#include <string>
#include <system_error>

namespace palpable {
namespace {

// A deck may begin with comments and blank lines, an XML text with a byte-order mark.
constexpr std::size_t kFirstBytes = 512;

std::string_view after_blanks(std::string_view text) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  const std::size_t at = text.find_first_not_of(" \t\r\n");
  return at == std::string_view::npos ? std::string_view{} : text.substr(at);
}

bool has_word(std::string_view text, std::string_view word) {
  return text.find(word) != std::string_view::npos;
}

std::string_view name_of(FileFormat format) {
  switch (format) {
    case FileFormat::kBody:
      return "body file";
    case FileFormat::kHdf5:
      return "HDF5 file, which is what is written";
    case FileFormat::kNpy:
      return "NumPy array, which is what is written";
    case FileFormat::kXml:
      return "XML file, which is what is written";
    case FileFormat::kGmsh:
      return "mesh of Gmsh, which is what is written";
    case FileFormat::kDeck:
      return "deck of Abaqus, which is what is written";
    case FileFormat::kRecording:
      return "recording of palpable live --record";
    case FileFormat::kWebFile:
      return "delivery file of palpable export --to web";
    case FileFormat::kHands:
      return "hands file, a line of JSON with a time and things";
  }
  return {};
}

}  // namespace

bool begins_as(std::string_view first, FileFormat format) {
  switch (format) {
    case FileFormat::kBody:
      return first.starts_with(kBodyMark);
    case FileFormat::kHdf5:
      return first.starts_with(kHdf5Mark);
    case FileFormat::kNpy:
      return first.starts_with(kNpyMark);
    case FileFormat::kXml:
      return after_blanks(first).starts_with('<');
    case FileFormat::kGmsh:
      return after_blanks(first).starts_with(kGmshMark);
    case FileFormat::kDeck:
      return after_blanks(first).starts_with('*');
    case FileFormat::kRecording:
      return first.starts_with(kRecordingMark);
    case FileFormat::kWebFile:
      return first.starts_with(kWebFileMark);
    case FileFormat::kHands:
      return after_blanks(first).starts_with('{') && has_word(first, "\"time\"") &&
             has_word(first, "\"things\"");
  }
  return false;
}

void guard_format(const std::filesystem::path& output, FileFormat format) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(output, error)) return;
  if (std::filesystem::file_size(output, error) == 0) return;
  std::string first(kFirstBytes, '\0');
  std::ifstream in(output, std::ios::binary);
  in.read(first.data(), static_cast<std::streamsize>(first.size()));
  first.resize(static_cast<std::size_t>(in.gcount()));
  if (begins_as(first, format)) return;
  throw Error(fmt::format(
      "{}: is there already and is no {}: it is somebody's and is not replaced; name another file",
      output.string(), name_of(format)));
}

}  // namespace palpable

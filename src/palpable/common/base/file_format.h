/// @file
/// Recognises a file's format by its first bytes, so that an output never replaces somebody's file
/// of another format.
#pragma once

#include <filesystem>
#include <string_view>

namespace palpable {

/// The first bytes of files, which their readers and writers know, too.
inline constexpr std::string_view kBodyMark = "palpable body file";
inline constexpr std::string_view kHdf5Mark = "\x89HDF\r\n\x1a\n";
inline constexpr std::string_view kNpyMark = "\x93NUMPY";
inline constexpr std::string_view kRecordingMark = "PALPREC\n";
inline constexpr std::string_view kWebFileMark = "PALPWEB\n";
/// After blanks.
inline constexpr std::string_view kGmshMark = "$MeshFormat";

enum class FileFormat {
  kBody,       ///< body files
  kHdf5,       ///< the numbers beside XDMF
  kNpy,        ///< NumPy arrays
  kXml,        ///< VTK grids (.vtu), XDMF, PXDMF
  kGmsh,       ///< .msh
  kDeck,       ///< .inp of Abaqus and CalculiX
  kRecording,  ///< of `live --record`
  kWebFile,    ///< delivery files of `export --to web`
  kHands,      ///< hands files of `palpable hands`
};

/// Whether bytes at the beginning of a file are those of the format. A deck is recognised by a line
/// that begins with '*', XML by '<' (after a byte-order mark and blanks).
[[nodiscard]] bool begins_as(std::string_view first, FileFormat format);

/// To be called before the work. A file that is not there, or is empty, may be written.
/// @throws Error "FILE: is there already and is no ..." when the file there has another format: it
/// is
///         somebody's, and whoever overwrote it would lose it
void guard_format(const std::filesystem::path& output, FileFormat format);

}  // namespace palpable

/// @file
/// Delivery files, NAME.palpweb: a body and its tables of touch as one file that a page fetches and
/// the core in WebAssembly reads, without HDF5. Made from a body file (palpable export --to web).
///
///     bytes 0 .. 7     "PALPWEB\n"
///     8 .. 15          uint64: bytes of the whole file
///     16 .. 23         uint64: WordHash (checksum.h) of all bytes from 24 on, added as one piece
///     24 .. 31         uint64: H, bytes of the header; a multiple of 16
///     32 .. 32+H-1     the header: JSON, filled up with blanks
///     from 32+H on     the arrays, each on a multiple of 16 bytes, zeros between them
///
/// All numbers are little-endian. The header is one object:
///
///     {"format": "palpable web body", "version": 1, "byte_order": "little", "name": "bunny",
///      "values": {"largest_von_mises": 133449.0, ...},
///      "provenance": {...},
///      "arrays": [{"name": "surface/vertices", "type": "float64", "shape": [1279, 3],
///                  "offset": 0}, ...]}
///
/// `type` is int16, int32, uint8, float32 or float64; `shape` has one or two numbers, the last one
/// runs fastest; `offset` counts from 32+H, rises from array to array and is a multiple of 16. So a
/// page can view an array in place: new Int16Array(buffer, 32 + H + offset, count). The names, and
/// what arrays and values mean: docs/body_file.md#delivery-file.
///
/// Tables of touch are the 16-bit numbers of memory: reading copies each array once. What the live
/// half does not use is left out: the volume. A body with further parameters is delivered
/// settled().
#pragma once

#include "palpable/common/base/error.h"
#include "palpable/common/response/touchable_body.h"

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace palpable {

/// Version of the layout that this program writes and reads. Files of another one are refused:
/// they are made again from the body file in a second.
inline constexpr int kWebFileVersion = 1;

/// How the names of delivery files end.
inline constexpr std::string_view kWebFileEnding = ".palpweb";

/// Reads and checks a delivery file in memory. For any bytes, the result is a body that satisfies
/// every rule of reduced_body.h, with tables that belong to it, or a problem of one line without a
/// file's name. Nothing outside `bytes` is read, and nothing is thrown. `bytes` need not be aligned
/// and are not needed afterwards.
[[nodiscard]] Result<TouchableBody> read_web_file(std::span<const std::byte> bytes);

/// The same for a file, which the problem names.
[[nodiscard]] Result<TouchableBody> load_web_file(const std::filesystem::path& path);

/// The bytes of a delivery file, from which read_web_file() restores every value but the volume to
/// the bit. The same body gives the same bytes.
/// @throws Error for a body that read_web_file() would refuse, or that is not settled
[[nodiscard]] std::string web_file_bytes(const TouchableBody& body);

/// Writes a delivery file under another name and renames it: a reader sees the former file or the
/// complete new one.
/// @throws Error as web_file_bytes(), and if the file cannot be written; both name the file
void write_web_file(const std::filesystem::path& path, const TouchableBody& body);

/// Bytes with the size and the checksum that belong to them, for tests that change a file behind
/// its checksum; bytes that are too few for them are unchanged.
[[nodiscard]] std::string with_web_checksum(std::string bytes);

}  // namespace palpable

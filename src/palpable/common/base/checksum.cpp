#include "palpable/common/base/checksum.h"

#include <fstream>
#include <string>
#include <system_error>

namespace palpable {

Result<std::uint64_t> file_checksum(const std::filesystem::path& path) {
  constexpr std::size_t kPiece = std::size_t{1} << 20;  // bytes; another size, another checksum
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return Problem{"no such file"};
  std::ifstream file(path, std::ios::binary);
  std::string piece(kPiece, '\0');
  WordHash hash;
  while (file) {
    file.read(piece.data(), static_cast<std::streamsize>(piece.size()));
    if (file.gcount() > 0) hash.add(piece.data(), static_cast<std::size_t>(file.gcount()));
  }
  if (!file.eof()) return Problem{"cannot be read"};
  return hash.value();
}

}  // namespace palpable

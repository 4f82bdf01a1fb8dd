#include "palpable/common/base/checksum.h"

#include "palpable/common/base/whole_file.h"

#include <fstream>
#include <string>
#include <utility>

namespace palpable {

Result<std::uint64_t> file_checksum(const std::filesystem::path& path) {
  constexpr std::size_t kPiece = std::size_t{1} << 20;  // bytes; another size, another checksum
  if (std::string why = why_no_file(path); !why.empty()) return Problem{std::move(why)};
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

#include "palpable/live/live_page/page_access.h"

#include "palpable/common/base/error.h"
#include "palpable/live/page/folder_server.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <sys/random.h>

namespace palpable {
namespace {

constexpr std::string_view kScheme = "http://";

bool is_our_origin(std::string_view origin, int port) {
  return origin.starts_with(kScheme) && names_this_machine(origin.substr(kScheme.size()), port);
}

}  // namespace

std::string new_page_token() {
  std::array<unsigned char, 16> bytes{};
  if (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) {
    throw Error("the system has no random numbers for the page's address");
  }
  std::string token;
  for (const unsigned char byte : bytes) token += fmt::format("{:02x}", byte);
  return token;
}

bool is_same_secret(std::string_view one, std::string_view other) {
  if (one.size() != other.size()) return false;
  // volatile: a compiler must not end the loop at the first difference.
  volatile unsigned char differs = 0;
  for (std::size_t k = 0; k < one.size(); ++k) {
    differs = static_cast<unsigned char>(differs | (one[k] ^ other[k]));
  }
  return differs == 0;
}

PageAccess page_access(const PageRequest& request, std::string_view token, int port) {
  if (!request.host || !names_this_machine(*request.host, port)) return {403};
  if (request.origin && !is_our_origin(*request.origin, port)) return {403};
  std::string_view path = request.target.substr(0, request.target.find_first_of("?#"));
  if (!path.starts_with('/')) return {400};
  path.remove_prefix(1);
  const std::size_t end = path.find('/');
  if (end == std::string_view::npos || !is_same_secret(path.substr(0, end), token)) return {403};
  if (request.method != "GET" && (request.method != "HEAD" || request.upgrades)) return {405};
  return {200, path.substr(end + 1)};
}

}  // namespace palpable

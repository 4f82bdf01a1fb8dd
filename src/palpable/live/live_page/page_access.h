/// @file
/// Who may read the page of a running session: the picture is of a room.
///
/// Three checks, of which each stops something else:
///
///     Host    a page of another site whose name was pointed to this machine (DNS rebinding)
///     Origin  a page of another site that opens our address: browsers send theirs with a WebSocket
///     token   other users and programs of this machine, which see neither terminal nor browser
///
/// A program that is no browser sends no Origin; for it the token suffices.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace palpable {

/// 32 hexadecimal digits, 128 bits of the system's random source. @throws Error if there are none
[[nodiscard]] std::string new_page_token();

/// Whether two texts are equal, in a time that depends on their lengths alone.
[[nodiscard]] bool is_same_secret(std::string_view one, std::string_view other);

/// What the server reads of the head of a request.
struct PageRequest {
  std::string_view method;
  std::string_view target;                      ///< "/TOKEN/page.js?x"
  std::optional<std::string_view> host = {};    ///< nothing also if there are several
  std::optional<std::string_view> origin = {};  ///< nothing: not sent
  bool upgrades = false;                        ///< to a WebSocket
};

/// The name below "/TOKEN/": empty for the page itself; or the status with which the request is
/// refused.
struct PageAccess {
  int status = 200;  ///< of HTTP; 403 for a wrong host, origin or token, 405 for another method
  std::string_view name = {};
};
[[nodiscard]] PageAccess page_access(const PageRequest& request, std::string_view token, int port);

}  // namespace palpable

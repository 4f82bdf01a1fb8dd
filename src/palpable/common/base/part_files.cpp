#include "palpable/common/base/part_files.h"

#include "palpable/common/base/text_numbers.h"

#include <fmt/format.h>

#include <cerrno>
#include <csignal>
#include <limits>
#include <unistd.h>

namespace palpable {
namespace {

std::string suffix_of_this_machine() {
  char host[256] = {};
  ::gethostname(host, sizeof host - 1);
  return fmt::format(".part-{}-", host);
}

}  // namespace

std::string own_part_suffix() { return suffix_of_this_machine() + std::to_string(::getpid()); }

bool is_part_of_running_process(std::string_view name) {
  const std::string suffix = suffix_of_this_machine();
  const std::size_t at = name.find(suffix);
  if (at == std::string_view::npos) return false;
  const auto process = to_whole_number(name.substr(at + suffix.size())).value_or(0);
  if (process <= 0 || process > std::numeric_limits<pid_t>::max()) return false;
  return ::kill(static_cast<pid_t>(process), 0) == 0 || errno == EPERM;
}

}  // namespace palpable

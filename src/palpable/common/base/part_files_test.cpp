#include "palpable/common/base/part_files.h"

#include "tests/support/test.h"

#include <sys/wait.h>
#include <unistd.h>

namespace palpable {
namespace {

TEST_CASE("a growing file is told from what a process that ended has left", "[base][files]") {
  CHECK(is_part_of_running_process("site_0003.h5" + own_part_suffix()));
  CHECK_FALSE(is_part_of_running_process("site_0003.h5"));
  CHECK_FALSE(is_part_of_running_process("site_0003.h5.part-another-host-1"));
  // Where a part's name would have the process.
  const std::string no_part(own_part_suffix().rfind('-'), 'x');
  CHECK_FALSE(is_part_of_running_process(no_part + std::to_string(::getpid())));
  // A number that was a process's a moment ago.
  const pid_t ended = ::fork();
  if (ended == 0) ::_exit(0);
  REQUIRE(::waitpid(ended, nullptr, 0) == ended);
  std::string suffix = own_part_suffix();
  suffix.resize(suffix.rfind('-') + 1);
  CHECK_FALSE(is_part_of_running_process("site_0003.h5" + suffix + std::to_string(ended)));
  CHECK_FALSE(is_part_of_running_process("site_0003.h5" + suffix));
}

}  // namespace
}  // namespace palpable

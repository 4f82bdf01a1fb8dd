#include "palpable/common/base/part_files.h"

#include "tests/support/test.h"

#include <sys/wait.h>
#include <unistd.h>

namespace palpable {
namespace {

TEST_CASE("the unfinished file of a running process is distinguished from that of an ended one",
          "[base][files]") {
  CHECK(is_part_of_running_process("site_0003.h5" + own_part_suffix()));
  CHECK_FALSE(is_part_of_running_process("site_0003.h5"));
  CHECK_FALSE(is_part_of_running_process("site_0003.h5.part-another-host-1"));
  // A name that has the process number at the right position but another text before it.
  const std::string no_part(own_part_suffix().rfind('-'), 'x');
  CHECK_FALSE(is_part_of_running_process(no_part + std::to_string(::getpid())));
  // The number of a process that has just ended.
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

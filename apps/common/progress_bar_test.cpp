#include "apps/common/progress_bar.h"

#include "tests/support/test.h"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>

namespace palpable::app {
namespace {

using Catch::Matchers::Contains;

// The output of a bar during `work`.
template <class Work>
std::string printed(bool terminal, const Work& work) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::tmpfile(), &std::fclose);
  {
    ProgressBar bar(file.get(), terminal);
    work(bar);
  }
  std::rewind(file.get());
  std::string text;
  for (int c = std::fgetc(file.get()); c != EOF; c = std::fgetc(file.get())) {
    text += static_cast<char>(c);
  }
  return text;
}

TEST_CASE("a bar on a terminal that was closed does not stop the work", "[apps][progress]") {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> full(std::fopen("/dev/full", "w"),
                                                             &std::fclose);
  std::setvbuf(full.get(), nullptr, _IONBF, 0);  // unbuffered, as stderr is
  const auto work = [&](bool terminal) {
    ProgressBar bar(full.get(), terminal);
    for (int i = 0; i <= 5; ++i) bar.show({"first", double(i), 5, ""});
    bar.say("the camera is gone");
    bar.show({"second", 0, 3, ""});
  };
  CHECK_NOTHROW(work(true));
  CHECK_NOTHROW(work(false));
}

TEST_CASE("a log gets one line for a short task, a terminal the same line redrawn",
          "[apps][progress]") {
  const auto work = [](ProgressBar& bar) {
    for (int i = 0; i <= 50; ++i) bar.show({"first", double(i), 50, ""});
    bar.show({"second", 0, 3, ""});
  };
  const auto talk = [](ProgressBar& bar) {
    bar.show({"first", 1, 2, ""});
    bar.say("the camera is gone");
  };
  CHECK_THAT(printed(true, talk), Contains("\x1b[K\nthe camera is gone\n"));
  const std::string log = printed(false, work);
  CHECK(std::count(log.begin(), log.end(), '\n') == 2);
  CHECK_THAT(log, Contains("first") && Contains("100 %") && Contains("second") && !Contains("\r"));
  const std::string bar = printed(true, work);
  CHECK(std::count(bar.begin(), bar.end(), '\n') == 2);
  CHECK_THAT(bar, Contains("\rfirst"));
}

TEST_CASE("a bar that never showed anything prints nothing", "[apps][progress]") {
  CHECK(printed(true, [](ProgressBar&) {}).empty());
  CHECK(printed(false, [](ProgressBar&) {}).empty());
}

}  // namespace
}  // namespace palpable::app

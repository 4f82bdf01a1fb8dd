#include "apps/palpable/kept_picture.h"

#include "apps/common/command_line.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/output_file.h"
#include "palpable/live/render/picture_file.h"

#include <fmt/core.h>

#include <cstdio>

namespace palpable::app {

namespace fs = std::filesystem;

std::string keep_picture(const fs::path& body, const std::string& what, const ColorImage& picture) {
  try {
    const auto name = [&](int n) {
      return fmt::format("{}_{}_{}.png", body.stem().string(), what, n);
    };
    int n = 1;
    std::error_code ignored;
    while (fs::exists(name(n), ignored)) ++n;
    guard_output_file(name(n), {body});
    write_png(name(n), picture);
    fmt::print("{}\n", name(n));
    std::fflush(stdout);  // at once also for a pipe: the window may stay open for long
    return name(n);
  } catch (const Error& error) {
    print_error(error.what());
    return error.what();
  }
}

}  // namespace palpable::app

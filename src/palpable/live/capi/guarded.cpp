#include "palpable/live/capi/guarded.h"

#include <array>

namespace palpable {
namespace {

thread_local std::array<char, 512> text_of_failure{};

}  // namespace

palpable_status failed(palpable_status status, std::string_view why) {
  const std::size_t length = std::min(why.size(), text_of_failure.size() - 1);
  std::copy_n(why.data(), length, text_of_failure.data());
  text_of_failure[length] = '\0';
  return status;
}

const char* last_failure() { return text_of_failure.data(); }

}  // namespace palpable

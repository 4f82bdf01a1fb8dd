/// @file
/// The border between C++ and C: exceptions become status and text, and structs may grow.
#pragma once

#include "palpable/live/capi/palpable.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <exception>
#include <new>
#include <string>
#include <string_view>
#include <utility>

namespace palpable {

/// Stores the text for palpable_last_error() of this thread, truncated to 511 bytes, and returns
/// the status. Allocates nothing.
palpable_status failed(palpable_status status, std::string_view why);
[[nodiscard]] const char* last_failure();

/// Thrown inside a C function when its arguments are invalid, before anything was changed.
class Failure : public std::exception {
 public:
  Failure(palpable_status status, std::string why) : status_(status), why_(std::move(why)) {}
  [[nodiscard]] palpable_status status() const { return status_; }
  [[nodiscard]] const char* what() const noexcept override { return why_.c_str(); }

 private:
  palpable_status status_;
  std::string why_;
};

/// Runs the content of a C function and converts every exception to a status.
template <class Function>
[[nodiscard]] palpable_status guarded(const Function& function) noexcept {
  try {
    function();
    return PALPABLE_OK;
  } catch (const Failure& failure) {
    return failed(failure.status(), failure.what());
  } catch (const std::bad_alloc&) {
    return failed(PALPABLE_NO_MEMORY, "out of memory");
  } catch (const std::exception& error) {
    return failed(PALPABLE_BROKEN, error.what());
  } catch (...) { return failed(PALPABLE_BROKEN, "an exception that is none of the library's"); }
}

/// Bytes. No struct of any version is larger; a larger `size` is an uninitialized one.
inline constexpr std::size_t kLargestStruct = 4096;

/// @throws Failure with PALPABLE_WRONG_ARGUMENT
inline void require(bool condition, const char* meaning) {
  if (!condition) throw Failure(PALPABLE_WRONG_ARGUMENT, meaning);
}

/// The size that the caller states for its struct.
/// @param least  bytes of the struct in the first version
/// @throws Failure when the struct is null or its size is impossible
template <class Struct>
[[nodiscard]] std::size_t size_of_callers(const Struct* its, std::size_t least, const char* name) {
  if (its == nullptr) throw Failure(PALPABLE_WRONG_ARGUMENT, std::string(name) + " is null");
  if (its->size < least || its->size > kLargestStruct) {
    throw Failure(PALPABLE_WRONG_ARGUMENT,
                  std::string(name) + ": size is to be that of the struct");
  }
  return its->size;
}

/// Copies a caller's struct, which may be of an older or a newer version. Members that an older
/// caller does not have become 0.
/// @throws Failure as size_of_callers(), and when members are set that this version does not have
template <class Struct>
[[nodiscard]] Struct taken_in(const Struct* from, std::size_t least, const char* name) {
  const std::size_t size = size_of_callers(from, least, name);
  const auto* bytes = reinterpret_cast<const unsigned char*>(from);
  for (std::size_t k = sizeof(Struct); k < size; ++k) {
    if (bytes[k] == 0) continue;
    throw Failure(
        PALPABLE_NOT_POSSIBLE,
        std::string(name) + ": has members that this version of the library does not know");
  }
  Struct into{};
  std::memcpy(&into, bytes, std::min(size, sizeof(Struct)));
  return into;
}

/// Copies a result into the caller's struct. Members that this version does not have become 0.
template <class Struct>
void hand_out(const Struct& from, std::size_t least, Struct* into, const char* name) {
  const std::size_t size = size_of_callers(into, least, name);
  auto* bytes = reinterpret_cast<unsigned char*>(into);
  const std::size_t known = std::min(size, sizeof(Struct));
  std::memcpy(bytes, &from, known);
  std::memset(bytes + known, 0, size - known);
  into->size = size;
}

}  // namespace palpable

/// @file
/// Checks of arguments that several C functions share.
#pragma once

#include "palpable/live/capi/c_session.h"
#include "palpable/live/capi/guarded.h"
#include "palpable/live/capi/palpable.h"

#include <fmt/core.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace palpable {

/// The session behind a handle.
/// @throws Failure when it is null or broken
[[nodiscard]] inline const palpable_session& opened(const palpable_session* session) {
  require(session != nullptr, "session is null");
  if (session->is_broken) {
    throw Failure(PALPABLE_BROKEN,
                  "an earlier call broke off half way: reset or close the session");
  }
  return *session;
}
[[nodiscard]] inline palpable_session& opened(palpable_session* session) {
  return const_cast<palpable_session&>(opened(static_cast<const palpable_session*>(session)));
}

/// As opened().
/// @throws Failure also when palpable_keep_frame() took the arrays
[[nodiscard]] inline const palpable_session& opened_with_arrays(const palpable_session* session) {
  const palpable_session& open = opened(session);
  if (open.arrays_are_kept) {
    throw Failure(PALPABLE_NOT_POSSIBLE,
                  "palpable_keep_frame() took the arrays of this frame: the next one has new ones");
  }
  return open;
}

/// @throws Failure for a session of another kind than a function is for
inline void require_kind(bool fits, const char* function) {
  if (fits) return;
  throw Failure(PALPABLE_NOT_POSSIBLE,
                fmt::format("{} is for a session with another kind of camera", function));
}

/// @param time  s, of the next frame
/// @throws Failure when it is not larger than that of the frame before, or out of its range
inline void check_time(const palpable_session& session, double time) {
  constexpr double kLatest = 1e12;  // s, 30,000 years: nanoseconds since 1970 are refused
  if (!(std::abs(time) < kLatest)) {
    throw Failure(PALPABLE_WRONG_ARGUMENT,
                  fmt::format("time is {} s, which is not within {} s from 0", time, kLatest));
  }
  if (!session.is_first() && !(time > session.last_time())) {
    throw Failure(PALPABLE_WRONG_ARGUMENT,
                  fmt::format("time is {} s and that of the frame before was {} s", time,
                              session.last_time()));
  }
}

/// @param what  the element's name in the message
/// @throws Failure when there is no such element
template <class Element>
[[nodiscard]] std::size_t checked_index(std::int32_t index, const std::vector<Element>& among,
                                        const char* what) {
  if (index < 0 || static_cast<std::size_t>(index) >= among.size()) {
    throw Failure(PALPABLE_WRONG_ARGUMENT,
                  fmt::format("there is no {} {} among {}", what, index, among.size()));
  }
  return static_cast<std::size_t>(index);
}

}  // namespace palpable

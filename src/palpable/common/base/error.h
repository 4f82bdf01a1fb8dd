/// @file
/// How the two halves report input that is unusable and computations that fail.
///
/// Offline (solid, bake, the programs' command lines) throws Error. The live half returns
/// Result<T>, a value or a Problem. Inside the frame loop even that is too costly: there, ordinary
/// values stand for failures (no depth here, nothing near). For bugs of the caller see contract.h.
#pragma once

#include "palpable/common/base/contract.h"

#include <stdexcept>
#include <string>
#include <utility>
#include <variant>

namespace palpable {

/// What went wrong, where, and what to try: one line for a person, without a final full stop.
/// Names the file (and line, where there is one), the value found and the limit.
struct Problem {
  std::string message;
};

/// Thrown by offline code when its input is unusable or a computation fails.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
  explicit Error(const Problem& problem) : std::runtime_error(problem.message) {}
};

/// A value, or the problem that prevented it. Asking for the other one throws ContractViolation.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : content_(std::move(value)) {}            // NOLINT: conversion is the purpose
  Result(Problem problem) : content_(std::move(problem)) {}  // NOLINT: conversion is the purpose

  [[nodiscard]] bool ok() const { return std::holds_alternative<T>(content_); }
  explicit operator bool() const { return ok(); }

  [[nodiscard]] const T& value() const& {
    PALPABLE_EXPECT(ok(), "a result that is a problem has no value");
    return std::get<T>(content_);
  }
  [[nodiscard]] T& value() & {
    PALPABLE_EXPECT(ok(), "a result that is a problem has no value");
    return std::get<T>(content_);
  }
  [[nodiscard]] T&& value() && {
    PALPABLE_EXPECT(ok(), "a result that is a problem has no value");
    return std::get<T>(std::move(content_));
  }
  [[nodiscard]] const Problem& problem() const {
    PALPABLE_EXPECT(!ok(), "a result that is a value has no problem");
    return std::get<Problem>(content_);
  }

 private:
  std::variant<T, Problem> content_;
};

/// For offline code: returns the value, or throws the problem as an Error.
template <class T>
[[nodiscard]] T value_or_throw(Result<T> result) {
  if (!result.ok()) throw Error(result.problem());
  return std::move(result).value();
}

}  // namespace palpable

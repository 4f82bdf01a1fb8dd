/// @file
/// What is said between a live run and the process that answers loads exactly, as bytes.
///
///   W  nodes of the shell
///
/// A message is a header and its payload, in the machine's own order of bytes: both programs are of
/// one build and run on one machine.
///
///     kReady   from the answerer, once: it knows the body. No payload, count is W
///     kLoad    a load to be answered: count times { vertex int32, force 3 x float32 N }
///     kAnswer  to the load of the same number: 3 W float32, m; count is W, or 0 without payload
///              where the body does not bear the load
///     kSorry   from the answerer, instead: it cannot do this body. count bytes of text say why
#pragma once

#include "palpable/common/response/nonlinear_response.h"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace palpable {

struct ExactMessage {
  enum class Kind : std::uint32_t { kReady = 1, kLoad, kAnswer, kSorry };
  Kind kind = Kind::kReady;
  std::uint32_t number = 0;  ///< of the load
  std::uint32_t count = 0;
  std::span<const std::byte> payload;  ///< of the stream that it was read from, until that goes on

  /// @pre kind is kLoad. @param forces  overwritten
  void read_load(std::vector<VertexForce>& forces) const;
  /// @pre kind is kAnswer, and count is above 0. @param field  (3 x W), overwritten
  void read_solution(Eigen::Matrix3Xf& field) const;
  [[nodiscard]] std::string_view text() const;  ///< @pre kind is kSorry
};

/// Overwrite `bytes` with a message; no allocation where it has had its room.
void write_ready(int nodes, std::vector<std::byte>& bytes);
void write_load(std::uint32_t number, std::span<const VertexForce> forces,
                std::vector<std::byte>& bytes);
/// @param field  (3 x W); nothing: the body does not bear the load
void write_solution(std::uint32_t number, const std::optional<Eigen::Matrix3Xf>& field,
                    std::vector<std::byte>& bytes);
void write_sorry(std::string_view why, std::vector<std::byte>& bytes);

/// Messages out of a stream of bytes that comes in pieces. Allocates in its constructor only.
class ExactMessages {
 public:
  /// @param largest  payload that can be meant, bytes
  explicit ExactMessages(std::size_t largest);

  /// Where the next bytes are to be written to, never empty after next() has found nothing.
  [[nodiscard]] std::span<std::byte> room();
  /// So many were written there.
  void add(std::size_t count);
  /// The next whole message, whose payload stays until add(). Nothing: more bytes are needed, or
  /// broken().
  [[nodiscard]] std::optional<ExactMessage> next();
  /// What came is no message; nothing is found any more.
  [[nodiscard]] bool broken() const { return broken_; }

 private:
  std::vector<std::byte> bytes_;
  std::size_t used_ = 0, filled_ = 0;  // bytes of messages that were found; bytes written
  bool broken_ = false;
};

}  // namespace palpable

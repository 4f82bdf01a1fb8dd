/// @file
/// The messages between a live run and the process that computes full-order solutions (the solver
/// process), as bytes.
///
///   W  nodes of the shell
///
/// A message is a header and its payload, in the machine's own byte order: both programs are of one
/// build and run on one machine.
///
///     kReady   from the solver process, once: it has loaded the body. No payload, count is W
///     kLoad    a load to be solved: count times { vertex int32, force 3 x float32 N }
///     kAnswer  the solution of the load of the same number: 3 W float32, m; count is W, or 0
///              without payload where the body does not bear the load
///     kSorry   from the solver process: it cannot solve this body. count bytes of text say why
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
  std::uint32_t number = 0;  ///< of the load, to tell which one a solution belongs to
  std::uint32_t count = 0;
  std::span<const std::byte> payload;  ///< in ExactMessages' memory, valid until its next add()

  /// @pre kind is kLoad. @param forces  overwritten
  void read_load(std::vector<VertexForce>& forces) const;
  /// @pre kind is kAnswer, and count is above 0. @param field  (3 x W), overwritten
  void read_solution(Eigen::Matrix3Xf& field) const;
  [[nodiscard]] std::string_view text() const;  ///< @pre kind is kSorry
};

/// These overwrite `bytes` with a message. They do not allocate once `bytes` has had the room.
void write_ready(int nodes, std::vector<std::byte>& bytes);
void write_load(std::uint32_t number, std::span<const VertexForce> forces,
                std::vector<std::byte>& bytes);
/// @param field  (3 x W) m; nothing: the body does not bear the load
void write_solution(std::uint32_t number, const std::optional<Eigen::Matrix3Xf>& field,
                    std::vector<std::byte>& bytes);
void write_sorry(std::string_view why, std::vector<std::byte>& bytes);

/// Splits a stream of bytes that arrives in pieces into messages. Allocates in its constructor
/// only.
class ExactMessages {
 public:
  /// @param largest  bytes of a payload, at most; a longer one breaks the stream
  explicit ExactMessages(std::size_t largest);

  /// The memory to write the next bytes to; never empty after next() has returned nothing.
  [[nodiscard]] std::span<std::byte> room();
  /// `count` bytes were written to room().
  void add(std::size_t count);
  /// The next whole message, whose payload is valid until add(). Nothing: more bytes are needed, or
  /// the stream is broken().
  [[nodiscard]] std::optional<ExactMessage> next();
  /// Whether the stream held bytes that are no message; next() then returns nothing any more.
  [[nodiscard]] bool broken() const { return broken_; }

 private:
  std::vector<std::byte> bytes_;
  std::size_t used_ = 0, filled_ = 0;  // bytes of messages returned; bytes written
  bool broken_ = false;
};

}  // namespace palpable

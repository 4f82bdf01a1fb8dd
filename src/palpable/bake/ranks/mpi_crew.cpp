#include "palpable/bake/ranks/mpi_crew.h"

#include "palpable/common/base/error.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <mpi.h>
#include <mutex>
#include <optional>
#include <thread>
#include <unistd.h>
#include <utility>

namespace palpable {
namespace {

// Tags of the messages. From a follower: kRequest (a piece), kDone {piece, its result}, kFailed
// (text), kLeaving (no more requests). From the leader: kPiece {number or -1}, kList, kEnd {1: the
// work failed}.
enum Tag : int { kRequest = 1, kDone, kFailed, kLeaving, kPiece, kList, kEnd };

constexpr auto kPollInterval = std::chrono::milliseconds(2);

struct Message {
  int from = 0, tag = 0;
  std::vector<char> bytes;

  [[nodiscard]] std::vector<int> ints() const {
    std::vector<int> values(bytes.size() / sizeof(int));
    std::copy_n(bytes.data(), values.size() * sizeof(int), reinterpret_cast<char*>(values.data()));
    return values;
  }
};

std::optional<Message> receive_if_any(int from, int tag) {
  int is_there = 0;
  MPI_Status status;
  MPI_Iprobe(from, tag, MPI_COMM_WORLD, &is_there, &status);
  if (is_there == 0) return std::nullopt;
  int size = 0;
  MPI_Get_count(&status, MPI_BYTE, &size);
  Message message{status.MPI_SOURCE, status.MPI_TAG,
                  std::vector<char>(static_cast<std::size_t>(size))};
  MPI_Recv(message.bytes.data(), size, MPI_BYTE, message.from, message.tag, MPI_COMM_WORLD,
           MPI_STATUS_IGNORE);
  return message;
}

Message wait_for(int from, int tag) {
  while (true) {
    if (std::optional<Message> message = receive_if_any(from, tag)) return std::move(*message);
    std::this_thread::sleep_for(kPollInterval);
  }
}

void send(int to, int tag, const void* data, std::size_t bytes) {
  MPI_Send(data, static_cast<int>(bytes), MPI_BYTE, to, tag, MPI_COMM_WORLD);
}
void send(int to, int tag, const std::vector<int>& values) {
  send(to, tag, values.data(), values.size() * sizeof(int));
}

std::string message_of(const std::exception_ptr& problem) {
  try {
    std::rethrow_exception(problem);
  } catch (const std::exception& error) { return error.what(); }
}

}  // namespace

bool MpiCrew::is_launched() {
  const char* size = std::getenv("OMPI_COMM_WORLD_SIZE");
  return size != nullptr && std::atoi(size) > 1;
}

MpiCrew::MpiCrew(int* argc, char*** argv) {
  int provided = 0;
  MPI_Init_thread(argc, argv, MPI_THREAD_SERIALIZED, &provided);
  if (provided < MPI_THREAD_SERIALIZED) {
    throw Error(
        "this MPI cannot be used from several threads in turn; run without mpirun, in "
        "shards");
  }
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &size_);
  if (leads()) return;
  // Only the leader writes to stderr. A follower's stderr goes to a file, which end() prints if the
  // follower fails.
  kept_ = std::tmpfile();
  if (kept_ == nullptr) return;
  stderr_ = ::dup(STDERR_FILENO);
  ::dup2(::fileno(kept_), STDERR_FILENO);
}

MpiCrew::~MpiCrew() {
  if (!ended_) end(true);
}

int MpiCrew::threads(int wanted) const {
  if (wanted > 0) return wanted;
  const char* neighbours = std::getenv("OMPI_COMM_WORLD_LOCAL_SIZE");
  const int here = neighbours != nullptr ? std::max(1, std::atoi(neighbours)) : 1;
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()) / here);
}

std::vector<int> MpiCrew::agree(std::vector<int> list) {
  if (!leads()) return wait_for(0, kList).ints();
  for (int rank = 1; rank < size_; ++rank) send(rank, kList, list);
  return list;
}

void MpiCrew::share(int count, const std::function<void(const Pieces&)>& run,
                    const std::function<void(int, int)>& finished) {
  if (leads()) {
    lead(count, run, finished);
  } else {
    follow(run);
  }
}

void MpiCrew::lead(int count, const std::function<void(const Pieces&)>& run,
                   const std::function<void(int, int)>& finished) {
  std::atomic<int> next{0};
  std::atomic<bool> failed{false}, working{true};
  std::mutex finishing;
  std::exception_ptr problem;
  const auto fail = [&](const std::exception_ptr& what) {
    const std::lock_guard lock(finishing);
    if (!problem) problem = what;
    failed = true;
  };
  const auto piece = [&]() -> std::optional<int> {
    if (failed) return std::nullopt;
    const int i = next++;
    return i < count ? std::optional(i) : std::nullopt;
  };
  const auto done = [&](int i, int result) {
    const std::lock_guard lock(finishing);
    finished(i, result);
  };
  std::thread own([&] {
    try {
      run({piece, done});
    } catch (...) { fail(std::current_exception()); }
    working = false;
  });
  // Only this thread of the leader calls MPI.
  for (int followers = size_ - 1; followers > 0 || working;) {
    const std::optional<Message> message =
        followers > 0 ? receive_if_any(MPI_ANY_SOURCE, MPI_ANY_TAG) : std::nullopt;
    if (!message) {
      std::this_thread::sleep_for(kPollInterval);
    } else if (message->tag == kRequest) {
      send(message->from, kPiece, {piece().value_or(-1)});
    } else if (message->tag == kDone) {
      const std::vector<int> what = message->ints();
      done(what[0], what[1]);
    } else if (message->tag == kFailed) {
      fail(std::make_exception_ptr(
          Error(std::string(message->bytes.begin(), message->bytes.end()))));
    } else if (message->tag == kLeaving) {
      --followers;
    }
  }
  own.join();
  for (int rank = 1; rank < size_; ++rank) send(rank, kEnd, {problem ? 1 : 0});
  if (problem) std::rethrow_exception(problem);
}

void MpiCrew::follow(const std::function<void(const Pieces&)>& run) {
  std::mutex using_mpi;
  try {
    run({[&]() -> std::optional<int> {
           const std::lock_guard lock(using_mpi);
           send(0, kRequest, {0});
           const int i = wait_for(0, kPiece).ints()[0];
           return i < 0 ? std::nullopt : std::optional(i);
         },
         [&](int piece, int result) {
           const std::lock_guard lock(using_mpi);
           send(0, kDone, {piece, result});
         }});
  } catch (...) {
    const std::string text = message_of(std::current_exception());
    send(0, kFailed, text.data(), text.size());
  }
  send(0, kLeaving, {0});
  if (wait_for(0, kEnd).ints()[0] != 0) throw Error("another process of the campaign failed");
}

void MpiCrew::end(bool failed) {
  ended_ = true;
  if (leads()) {
    if (failed) MPI_Abort(MPI_COMM_WORLD, 1);
    for (int rank = 1; rank < size_; ++rank) send(rank, kEnd, {0});
    MPI_Finalize();
    return;
  }
  if (failed) {
    // The leader, which most often fails for the same reason, is given time to end the job itself.
    std::this_thread::sleep_for(std::chrono::seconds(3));
    if (kept_ != nullptr) {
      std::fflush(stderr);
      ::dup2(stderr_, STDERR_FILENO);
      std::rewind(kept_);
      for (int c = std::fgetc(kept_); c != EOF; c = std::fgetc(kept_)) std::fputc(c, stderr);
    }
    MPI_Abort(MPI_COMM_WORLD, 1);
  }
  (void)wait_for(0, kEnd);
  MPI_Finalize();
}

}  // namespace palpable

// Damages small valid files a thousand times and passes them to their readers, each in a process of
// its own, limited to 2 GB of memory and three seconds.
//
//   fuzz_readers --list                              names of readers
//   fuzz_readers surface.stl --count 1000            exit code 1 when a reader crashed, hung, or
//                                                    gave a message without the file's name
//   fuzz_readers surface.stl --first 17 --count 1    one damage again; the file is kept

#include "palpable/common/base/checksum.h"
#include "palpable/common/base/contract.h"
#include "tests/fuzz/fuzz_reader.h"
#include "tests/support/sanitizers.h"

#include <fmt/format.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <fcntl.h>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <poll.h>
#include <string>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace palpable::fuzz {
namespace {

namespace fs = std::filesystem;

#ifdef PALPABLE_ASAN
constexpr bool kSanitized = true;  // needs terabytes of address space, and more time
#else
constexpr bool kSanitized = false;
#endif
constexpr rlim_t kMemory = rlim_t{2} << 30;
constexpr int kMilliseconds = kSanitized ? 60'000 : 3'000;
constexpr int kMostFailuresShown = 20;

std::string bytes_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

void write_bytes(const fs::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary | std::ios::trunc)
      .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

// How a process ended, and its message.
struct End {
  bool hung = false;
  int status = 0;
  std::string message;

  [[nodiscard]] bool died() const {
    return !hung && !(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  }
};

// Runs `work` in a process of its own; its output goes to the file `printed`.
End run_apart(const std::function<std::string()>& work, const fs::path& printed) {
  int ends[2];
  if (::pipe(ends) != 0) throw Error(std::strerror(errno));
  const pid_t process = ::fork();
  if (process == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    ::close(ends[0]);
    const int out = ::open(printed.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
    ::dup2(out, STDOUT_FILENO);
    ::dup2(out, STDERR_FILENO);
    const rlimit memory{kMemory, kMemory}, none{0, 0};
    if (!kSanitized) ::setrlimit(RLIMIT_AS, &memory);
    ::setrlimit(RLIMIT_CORE, &none);
    std::string message;
    try {
      message = work();
    } catch (const std::exception& error) { message = error.what(); }
    const bool sent = ::write(ends[1], message.data(), message.size()) >= 0;
    ::_exit(sent ? 0 : 1);
  }
  ::close(ends[1]);
  End end;
  const auto begin = std::chrono::steady_clock::now();
  while (true) {
    const auto gone = std::chrono::duration_cast<std::chrono::milliseconds>(
        std::chrono::steady_clock::now() - begin);
    const int left = kMilliseconds - static_cast<int>(gone.count());
    pollfd ready{ends[0], POLLIN, 0};
    const int answer = left > 0 ? ::poll(&ready, 1, left) : 0;
    if (answer < 0 && errno == EINTR) continue;
    if (answer == 0) {
      end.hung = true;
      ::kill(process, SIGKILL);
      break;
    }
    char buffer[4096];
    const ssize_t got = ::read(ends[0], buffer, sizeof buffer);
    if (got <= 0) break;
    end.message.append(buffer, static_cast<std::size_t>(got));
  }
  ::close(ends[0]);
  while (::waitpid(process, &end.status, 0) < 0 && errno == EINTR) {}
  return end;
}

// What the reader did wrong with a damaged file; empty if nothing.
std::string fault_of(const End& end, const FuzzReader& reader, const fs::path& folder,
                     const fs::path& file) {
  if (end.hung) return fmt::format("not done after {} ms", kMilliseconds);
  if (end.died()) {
    return WIFSIGNALED(end.status) ? fmt::format("signal {}", WTERMSIG(end.status))
                                   : fmt::format("exit code {}", WEXITSTATUS(end.status));
  }
  if (end.message.empty()) return {};
  const auto has = [&](const std::string& text) {
    return end.message.find(text) != std::string::npos;
  };
  if (has(".cpp:") || has(".h:")) return "a place in our sources: " + end.message;
  if (has("\n")) return "more than one line: " + end.message;
  if (has("std::") || has("vector::") || has("basic_string")) return "C++'s words: " + end.message;
  const bool named = has(file.filename().string()) || (reader.names_folder && has(folder.string()));
  return named ? std::string() : "no name of the file in: " + end.message;
}

struct Options {
  std::string name;
  unsigned first = 0, count = 1000;
  fs::path work = fs::temp_directory_path() / "palpable_fuzz";
};

// The undamaged files, by their names.
std::map<std::string, std::string> valid_files(const FuzzReader& reader, const fs::path& folder,
                                               const fs::path& printed) {
  fs::remove_all(folder);
  fs::create_directories(folder);
  const End end = run_apart(
      [&] {
        std::string names;
        for (const std::string& name : reader.write(folder)) names += name + "\n";
        return names;
      },
      printed);
  if (end.died() || end.hung) {
    throw Error(
        fmt::format("{}: its valid files cannot be made: {}", reader.name, bytes_of(printed)));
  }
  std::map<std::string, std::string> files;
  std::string rest = end.message;
  while (!rest.empty()) {
    const std::string name = rest.substr(0, rest.find('\n'));
    rest.erase(0, name.size() + 1);
    files[name] = bytes_of(folder / name);
    if (!fs::exists(folder / name)) throw Error(fmt::format("{}: no file {}", reader.name, rest));
  }
  return files;
}

// @return number of files that the reader handled wrongly
int fuzz(const FuzzReader& reader, const Options& options) {
  const fs::path folder = options.work / (reader.name + "_files");
  const fs::path printed = options.work / (reader.name + "_printed.txt");
  const std::map<std::string, std::string> files = valid_files(reader, folder, printed);
  std::vector<std::string> names, contents;
  for (const auto& [name, bytes] : files) {
    names.push_back(name);
    contents.push_back(bytes);
  }
  // The undamaged files must be readable; otherwise all tests below would only show
  // that they are not.
  for (const std::string& name : names) {
    const End whole = run_apart([&] { return reader.read(folder, folder / name); }, printed);
    if (!whole.message.empty() || whole.died() || whole.hung) {
      throw Error(fmt::format("{}: the valid file {} is not read: {} {}", reader.name, name,
                              whole.message, bytes_of(printed)));
    }
  }
  int faults = 0, refused = 0;
  for (unsigned seed = options.first; seed < options.first + options.count; ++seed) {
    Random random(fnv1a(reader.name) ^ seed);
    const std::size_t which = seed % names.size();
    const fs::path file = folder / names[which];
    const std::string damaged = reader.mutate ? reader.mutate(contents[which], random)
                                              : mutated(contents[which], contents, random);
    write_bytes(file, damaged);
    const End end = run_apart([&] { return reader.read(folder, file); }, printed);
    const std::string fault = fault_of(end, reader, folder, file);
    if (!end.message.empty()) ++refused;
    if (!fault.empty() && ++faults <= kMostFailuresShown) {
      const fs::path kept = options.work / fmt::format("{}_{}", reader.name, seed) / names[which];
      fs::create_directories(kept.parent_path());
      write_bytes(kept, damaged);
      fmt::print("{} seed {}: {}\n  {}\n", reader.name, seed, fault, kept.string());
      if (end.died()) fmt::print("{}\n", bytes_of(printed).substr(0, 6000));
    }
    write_bytes(file, contents[which]);
  }
  fmt::print("{}: {} damaged files, {} refused, {} met wrongly\n", reader.name, options.count,
             refused, faults);
  fs::remove_all(folder);
  fs::remove(printed);
  return faults;
}

std::vector<FuzzReader> all_readers() {
  std::vector<FuzzReader> readers;
  add_surface_readers(readers);
  add_mesh_readers(readers);
  add_body_readers(readers);
  add_campaign_readers(readers);
  add_clip_readers(readers);
  add_source_readers(readers);
  add_score_readers(readers);
  return readers;
}

int run(int argc, char** argv) {
  Options options;
  const std::vector<FuzzReader> readers = all_readers();
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k];
    const auto value = [&]() -> std::string { return ++k < argc ? argv[k] : ""; };
    if (word == "--list") {
      for (const FuzzReader& reader : readers) fmt::print("{}\n", reader.name);
      return 0;
    }
    if (word == "--first") {
      options.first = static_cast<unsigned>(std::stoul(value()));
    } else if (word == "--count") {
      options.count = static_cast<unsigned>(std::stoul(value()));
    } else if (word == "--work") {
      options.work = value();
    } else {
      options.name = word;
    }
  }
  fs::create_directories(options.work);
  int faults = 0, found = 0;
  for (const FuzzReader& reader : readers) {
    if (!options.name.empty() && reader.name != options.name) continue;
    ++found;
    faults += fuzz(reader, options);
  }
  if (found == 0) throw Error(fmt::format("no reader is called '{}'; see --list", options.name));
  return faults > 0 ? 1 : 0;
}

}  // namespace
}  // namespace palpable::fuzz

int main(int argc, char** argv) {
  try {
    return palpable::fuzz::run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "fuzz_readers: {}\n", error.what());
    return 1;
  }
}

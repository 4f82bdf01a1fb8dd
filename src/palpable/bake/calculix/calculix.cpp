#include "palpable/bake/calculix/calculix.h"

#include "palpable/common/base/error.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/base/temporary_folder.h"
#include "palpable/common/geometry/quadrature.h"
#include "palpable/common/geometry/shape_gradients.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <iterator>
#include <sstream>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <utility>

namespace palpable {

using Eigen::Matrix3Xd;

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

// Name of all files of a run; short, because ccx keeps file names in 132 characters.
constexpr std::string_view kJob = "body";

// Messages of ccx that mean that it cannot follow the path any further.
constexpr std::array<std::string_view, 5> kGaveUp{
    "increment size smaller than minimum", "too many cutbacks", "too many iterations needed",
    "solution seems to diverge", "max. # of increments reached"};

// A child process. The destructor kills it if it is still running.
class Child {
 public:
  // Runs `program argument` in `folder` with one thread, its output going to `log`.
  Child(const fs::path& program, std::string_view argument, const fs::path& folder,
        const fs::path& log) {
    // All memory is allocated before the fork: between fork and exec only async-signal-safe calls
    // are allowed.
    const std::string program_text = program.string(), argument_text(argument);
    const std::string folder_text = folder.string(), log_text = log.string();
    std::array<char*, 3> arguments{const_cast<char*>(program_text.c_str()),
                                   const_cast<char*>(argument_text.c_str()), nullptr};
    std::vector<std::string> variables;
    for (char** entry = environ; *entry != nullptr; ++entry) {
      const std::string_view text(*entry);
      const auto is = [&](std::string_view name) { return text.starts_with(name); };
      // Each of these sets a number of threads for ccx or for what it links.
      if (is("OMP_NUM_THREADS=") || is("NUMBER_OF_CPUS=") || is("CCX_NPROC_") ||
          is("OPENBLAS_NUM_THREADS=")) {
        continue;
      }
      variables.emplace_back(text);
    }
    variables.insert(variables.end(), {"OMP_NUM_THREADS=1", "OPENBLAS_NUM_THREADS=1"});
    std::vector<char*> environment;
    for (std::string& variable : variables) environment.push_back(variable.data());
    environment.push_back(nullptr);

    pid_ = ::fork();
    if (pid_ < 0)
      throw Error(fmt::format("cannot start {}: {}", program_text, std::strerror(errno)));
    if (pid_ > 0) return;
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // otherwise an orphan runs on for minutes
    const int out = ::open(log_text.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    const int in = ::open("/dev/null", O_RDONLY);
    if (out < 0 || in < 0 || ::chdir(folder_text.c_str()) != 0) ::_exit(126);
    ::dup2(in, STDIN_FILENO);
    ::dup2(out, STDOUT_FILENO);
    ::dup2(out, STDERR_FILENO);
    ::execve(program_text.c_str(), arguments.data(), environment.data());
    ::_exit(127);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() {
    if (pid_ <= 0 || done_) return;
    ::kill(pid_, SIGKILL);
    while (::waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {}
  }

  // True once the program has ended; status() and cpu_seconds() are valid from then on.
  bool ended() {
    if (done_) return true;
    const pid_t found = ::wait4(pid_, &status_, WNOHANG, &usage_);
    if (found < 0 && errno != EINTR) {
      throw Error(fmt::format("lost sight of CalculiX: {}", std::strerror(errno)));
    }
    done_ = found == pid_;
    return done_;
  }
  [[nodiscard]] int status() const { return status_; }
  [[nodiscard]] double cpu_seconds() const {
    const auto seconds = [](const timeval& t) {
      return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return seconds(usage_.ru_utime) + seconds(usage_.ru_stime);
  }

 private:
  pid_t pid_ = -1;
  bool done_ = false;
  int status_ = 0;
  rusage usage_{};
};

// Summary of ccx's .sta file, which has one line for each attempt at an increment.
struct StaSummary {
  int increments = 0, iterations = 0;
  double level = 0;  // time, which is the level in our decks
};

StaSummary read_sta(const fs::path& path) {
  StaSummary summary;
  std::ifstream sta(path);
  std::string line;
  while (std::getline(sta, line)) {
    //   STEP      INC     ATT  ITRS     TOT TIME     STEP TIME      INC TIME
    // An attempt that did not converge has a U behind its number. The last line may be half
    // written.
    std::istringstream words(line);
    int step = 0, increment = 0, iterations = 0;
    std::string attempt;
    double time = 0, step_time = 0, increment_time = 0;
    if (!(words >> step >> increment >> attempt >> iterations >> time >> step_time >>
          increment_time)) {
      continue;
    }
    summary.iterations += iterations;
    if (attempt.ends_with('U')) continue;
    ++summary.increments;
    summary.level = time;
  }
  return summary;
}

std::string read_text(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

// The files of a run in a folder.
class JobFiles {
 public:
  // Makes the folder if it is absent.
  explicit JobFiles(const fs::path& folder) : folder_(fs::absolute(folder)) {
    make_folder(folder_);
  }
  [[nodiscard]] const fs::path& folder() const { return folder_; }
  [[nodiscard]] fs::path of(std::string_view ending) const {
    return folder_ / fmt::format("{}.{}", kJob, ending);
  }
  // Removes what an earlier run left, and writes the deck.
  void begin(const std::string& deck) const {
    std::error_code ignored;
    for (const std::string_view ending : {"dat", "sta", "frd", "cvg", "log"}) {
      fs::remove(of(ending), ignored);
    }
    write_whole_file(of("inp"), deck);
  }

 private:
  fs::path folder_;
};

void show_progress(const JobFiles& files, std::span<const double> levels,
                   const Progress& progress) {
  const StaSummary sta = read_sta(files.of("sta"));
  // Progress between two levels is interpolated.
  const auto above = std::upper_bound(levels.begin(), levels.end(), sta.level * (1.0 + 1e-6));
  double done = static_cast<double>(above - levels.begin());
  if (above != levels.end()) {
    const double below = above == levels.begin() ? 0.0 : *(above - 1);
    done += std::max(0.0, (sta.level - below) / (*above - below));
  }
  const auto level_count = static_cast<double>(levels.size());
  report(progress,
         {.task = "CalculiX",
          .done = std::min(done, level_count),
          .total = level_count,
          .note = fmt::format("{} increments, {} iterations", sta.increments, sta.iterations)});
}

// Waits until the program has ended. Polls after 2 ms and then ever more rarely, down to every 100
// ms, so that short runs are not delayed and long ones hardly disturbed.
void wait_for(Child& child, const JobFiles& files, std::span<const double> levels,
              const Progress& progress) {
  Clock::time_point shown = Clock::now();
  for (auto pause = std::chrono::milliseconds(2); !child.ended();
       pause = std::min(2 * pause, std::chrono::milliseconds(100))) {
    std::this_thread::sleep_for(pause);
    if (Clock::now() - shown > std::chrono::milliseconds(300)) {
      show_progress(files, levels, progress);
      shown = Clock::now();
    }
  }
}

// Throws unless the program ended with results.
// @returns whether CalculiX gave up before the last level, because the path does not continue
bool require_results(int status, const std::string& message, double level,
                     const std::string& where) {
  if (WIFSIGNALED(status)) {
    throw Error(
        fmt::format("CalculiX was ended by signal {} ({}) at level {:.4g}; out of memory?{}",
                    WTERMSIG(status), ::strsignal(WTERMSIG(status)), level, where));
  }
  const bool gave_up = std::any_of(kGaveUp.begin(), kGaveUp.end(), [&](std::string_view words) {
    return message.find(words) != std::string::npos;
  });
  if (!gave_up && (WEXITSTATUS(status) != 0 || !message.empty())) {
    throw Error(fmt::format(
        "CalculiX failed: {}{}",
        message.empty() ? fmt::format("exit code {}", WEXITSTATUS(status)) : message, where));
  }
  return gave_up;
}

std::vector<CalculixState> read_states(const JobFiles& files, const SolidModel& model,
                                       std::span<const double> levels) {
  std::ifstream dat(files.of("dat"), std::ios::binary);
  const CalculixDatLayout layout{.node_count = model.mesh.node_count(),
                                 .tet_count = model.mesh.tet_count(),
                                 .points = model.mesh.is_quadratic() ? 4 : 1,
                                 .levels = {levels.begin(), levels.end()},
                                 .units = calculix_units(model)};
  return value_or_throw(read_calculix_dat(dat, layout, files.of("dat").string()));
}

}  // namespace

std::string calculix_error(std::string_view log) {
  constexpr std::string_view kMark = "*ERROR";
  const std::size_t at = log.find(kMark);
  if (at == std::string_view::npos) return {};
  std::string_view rest = log.substr(at + kMark.size());
  std::string text;
  bool first = true;
  while (!rest.empty() && text.size() < 300) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos || (!first && line[begin] == '*')) break;
    first = false;
    for (const char c : line) {
      const bool blank = std::isprint(static_cast<unsigned char>(c)) == 0 || c == ' ';
      if (!blank) {
        text += c;
      } else if (!text.empty() && text.back() != ' ') {
        text += ' ';
      }
    }
    if (!text.empty() && text.back() != ' ') text += ' ';
  }
  while (!text.empty() && (text.back() == ' ' || text.back() == '.')) text.pop_back();
  const std::size_t begin = text.find_first_not_of(" :");
  return begin == std::string::npos ? std::string() : text.substr(begin);
}

Eigen::SparseMatrix<double> calculix_mass(const TetMesh& mesh, double density) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int e = 0; e < mesh.tet_count(); ++e) {
    const auto add = [&](const auto& nodes, const auto& N, double mass) {
      for (Eigen::Index a = 0; a < nodes.size(); ++a) {
        for (Eigen::Index b = 0; b < nodes.size(); ++b) {
          entries.emplace_back(nodes[a], nodes[b], mass * N[a] * N[b]);
        }
      }
    };
    if (!mesh.is_quadratic()) {
      add(Eigen::Vector4i(mesh.tets.col(e)), Eigen::Vector4d(Eigen::Vector4d::Constant(0.25)),
          density * shape_gradients(mesh, e).volume);
      continue;
    }
    for (const auto& [L, weight] : four_point_rule()) {
      const QuadraticShape shape = quadratic_shape(L);
      add(quadratic_nodes(mesh, e), shape.N,
          density * weight * quadratic_gradients(mesh, e, shape).volume);
    }
  }
  Eigen::SparseMatrix<double> M(mesh.node_count(), mesh.node_count());
  M.setFromTriplets(entries.begin(), entries.end());
  return M;
}

std::optional<fs::path> find_calculix(std::string_view program) {
  const auto runs = [](const fs::path& path) {
    std::error_code ignored;
    return fs::is_regular_file(path, ignored) && ::access(path.c_str(), X_OK) == 0;
  };
  if (program.empty()) return std::nullopt;
  if (program.find('/') != std::string_view::npos) {
    if (!runs(program)) return std::nullopt;
    return fs::absolute(program);
  }
  const char* const path = std::getenv("PATH");
  std::string_view rest = path != nullptr ? path : "/usr/bin:/bin";
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find(':'), rest.size());
    const fs::path folder(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (!folder.empty() && runs(folder / program)) return fs::absolute(folder / program);
  }
  return std::nullopt;
}

namespace {

fs::path program_of(const CalculixSettings& settings) {
  if (const auto program = find_calculix(settings.program)) return *program;
  throw Error(fmt::format(
      "CalculiX ({}) is not there or cannot be run; on Debian: apt install calculix-ccx",
      settings.program));
}

}  // namespace

std::vector<double> frequencies_by_calculix(const SolidModel& model, double density, int modes,
                                            const CalculixSettings& settings) {
  const std::string deck = calculix_frequency_deck(model, modes);
  const fs::path program = program_of(settings);
  std::optional<TemporaryFolder> temporary;
  if (settings.folder.empty()) temporary.emplace("palpable-ccx");
  const JobFiles files(temporary ? temporary->path() : settings.folder);
  files.begin(deck);
  Child child(program, kJob, files.folder(), files.of("log"));
  wait_for(child, files, {}, {});
  const std::string message = calculix_error(read_text(files.of("log")));
  if (require_results(child.status(), message, 0, "")) throw Error("CalculiX gave up: " + message);
  std::ifstream dat(files.of("dat"), std::ios::binary);
  std::vector<double> values =
      value_or_throw(read_calculix_eigenvalues(dat, modes, files.of("dat").string()));
  const double unit = calculix_eigenvalue_unit(model, density);
  for (double& value : values) value = std::sqrt(std::max(0.0, value * unit));
  return values;
}

CalculixRun solve_with_calculix(const SolidModel& model, const Matrix3Xd& full_load,
                                std::span<const double> levels, const CalculixSettings& settings,
                                const Progress& progress) {
  const std::string deck = calculix_deck(model, full_load, levels, settings.tolerance,
                                         settings.lid ? &*settings.lid : nullptr);
  const fs::path program = program_of(settings);
  std::optional<TemporaryFolder> temporary;
  if (settings.folder.empty()) temporary.emplace("palpable-ccx");
  const JobFiles files(temporary ? temporary->path() : settings.folder);
  files.begin(deck);

  const Clock::time_point start = Clock::now();
  Child child(program, kJob, files.folder(), files.of("log"));
  wait_for(child, files, levels, progress);
  CalculixRun run;
  run.wall_seconds = std::chrono::duration<double>(Clock::now() - start).count();
  run.cpu_seconds = child.cpu_seconds();
  const StaSummary sta = read_sta(files.of("sta"));
  run.increments = sta.increments;
  run.iterations = sta.iterations;
  run.last_level = sta.level;

  // Where the folder is kept, messages name its log file.
  const std::string where =
      temporary ? std::string() : fmt::format(" (see {})", files.of("log").string());
  const std::string message = calculix_error(read_text(files.of("log")));
  const bool gave_up = require_results(child.status(), message, sta.level, where);
  run.states = read_states(files, model, levels);
  run.complete = run.states.size() == levels.size();
  if (!run.complete && !gave_up) {
    throw Error(fmt::format("CalculiX ended well but printed {} of {} levels{}", run.states.size(),
                            levels.size(), where));
  }
  if (!run.complete) {
    run.why_stopped = fmt::format(
        "load level {:.6g} was not reached, the last increment that converged ended at {:.6g}: "
        "CalculiX: {}",
        levels[run.states.size()], run.last_level, message);
  }
  show_progress(files, levels, progress);
  return run;
}

}  // namespace palpable

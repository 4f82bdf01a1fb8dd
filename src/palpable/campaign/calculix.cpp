#include "palpable/campaign/calculix.h"

#include "palpable/base/contract.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <istream>
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

// Name of all files of a run; short, because ccx keeps file names in 132 characters.
constexpr std::string_view kJob = "body";

constexpr std::array<std::string_view, 5> kGaveUp{
    "increment size smaller than minimum", "too many cutbacks", "too many iterations needed",
    "solution seems to diverge", "max. # of increments reached"};

// The shortest form with the most digits that fits into the 20 characters that ccx reads.
std::string number(double value) {
  std::string text;
  for (int digits = 17; digits >= 12; --digits) {
    text = fmt::format("{:.{}g}", value, digits);
    if (text.size() <= 20) break;
  }
  // Without a point ccx would read 5 as an integer in some places and refuse it.
  if (text.find_first_of(".e") == std::string::npos) text += '.';
  return text;
}

void check_input(const SolidModel& model, const Matrix3Xd& load, std::span<const double> levels) {
  check_model(model);
  if (load.cols() != model.mesh.node_count()) {
    throw Error(fmt::format("the load has {} nodal forces and the body {} nodes", load.cols(),
                            model.mesh.node_count()));
  }
  if (!load.allFinite()) throw Error("a nodal force is not finite");
  const std::vector<HeldComponent> held = held_components(model);
  const bool moved = std::any_of(held.begin(), held.end(),
                                 [](const HeldComponent& h) { return h.displacement != 0.0; });
  if (load.isZero(0) && !moved) { throw Error("the load is zero; give a force"); }
  double before = 0.0;
  for (const double level : levels) {
    PALPABLE_EXPECT(level > before && std::isfinite(level), "levels are above 0 and increase");
    before = level;
  }
  PALPABLE_EXPECT(!levels.empty(), "at least one level");
}

// Material section of the deck; `unit` is Pa per unit of stress in the deck.
std::string material_section(const Material& material, const std::string& name, double unit) {
  if (const auto* m = std::get_if<SaintVenantKirchhoff>(&material)) {
    const double sum = m->lambda + m->mu;
    return fmt::format("*MATERIAL, NAME={}\n*ELASTIC\n{}, {}\n", name,
                       number(m->mu * (3.0 * m->lambda + 2.0 * m->mu) / sum / unit),
                       number(m->lambda / (2.0 * sum)));
  }
  if (const auto* m = std::get_if<NeoHookeanAbaqus>(&material)) {
    return fmt::format("*MATERIAL, NAME={}\n*HYPERELASTIC, NEO HOOKE\n{}, {}\n", name,
                       number(m->C10 / unit), number(m->D1 * unit));
  }
  throw Error(fmt::format(
      "CalculiX has no law like {}; use neo-hooke-abaqus or saint-venant-kirchhoff, or our solver",
      law_name(material)));
}

// A folder that is gone at the end.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (fs::temp_directory_path() / "palpable-ccx-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) {
      throw Error(fmt::format("cannot make a temporary folder {}: {}", name, std::strerror(errno)));
    }
    path_ = name;
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

// A running program; killed if its owner leaves before it is done.
class Child {
 public:
  // Runs `program argument` in `folder` with one thread, its output going to `log`.
  Child(const fs::path& program, std::string_view argument, const fs::path& folder,
        const fs::path& log) {
    // All memory is taken before the fork: in between only calls that are safe there.
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
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // an orphan would go on for minutes
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

  // True once the program has ended; then status() and usage() say how.
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

// What ccx's .sta file tells: one line for each attempt at an increment.
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

// Fortran prints three digits of exponent without the E: 1.234567-101.
bool parse_fortran(std::string_view word, double& value) {
  if (word.starts_with('+')) word.remove_prefix(1);
  const char* const end = word.data() + word.size();
  const auto [stop, code] = std::from_chars(word.data(), end, value);
  if (code == std::errc() && stop == end) return std::isfinite(value);
  const std::size_t sign = word.find_first_of("+-", 1);
  if (sign == std::string_view::npos || word.find_first_of("eE") != std::string_view::npos) {
    return false;
  }
  const std::string with_e = fmt::format("{}E{}", word.substr(0, sign), word.substr(sign));
  const char* const with_e_end = with_e.data() + with_e.size();
  const auto [stop_e, code_e] = std::from_chars(with_e.data(), with_e_end, value);
  // Below the smallest double is zero, as far as a printed result is concerned.
  if (code_e == std::errc::result_out_of_range && word[sign] == '-') {
    value = 0.0;
    return true;
  }
  return code_e == std::errc() && stop_e == with_e_end && std::isfinite(value);
}

bool parse_index(std::string_view word, int& value) {
  const auto [stop, code] = std::from_chars(word.data(), word.data() + word.size(), value);
  return code == std::errc() && stop == word.data() + word.size();
}

// The words of a line, at most as many as fit; `count` may be larger.
template <std::size_t Most>
std::array<std::string_view, Most> split(std::string_view line, std::size_t& count) {
  std::array<std::string_view, Most> words;
  count = 0;
  for (;;) {
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos) return words;
    line.remove_prefix(begin);
    const std::size_t length = std::min(line.find_first_of(" \t\r"), line.size());
    if (count < Most) words[count] = line.substr(0, length);
    ++count;
    line.remove_prefix(length);
  }
}

// Reads a .dat file line by line; what it throws never leaves this file.
class DatReader {
 public:
  struct Bad {
    std::string what;
  };

  DatReader(std::istream& in, const CalculixDatLayout& layout) : in_(in), layout_(layout) {}

  [[nodiscard]] long line_number() const { return line_number_; }

  std::vector<CalculixState> read() {
    std::vector<CalculixState> states;
    while (next_line_with_words()) {
      const double time = heading("displacements");
      if (states.size() == layout_.levels.size()) {
        throw Bad{fmt::format("a result at time {}, after all {} levels", time, states.size())};
      }
      const double level = layout_.levels[states.size()];
      CalculixState state;
      state.level = level;
      need_level(time, level);
      state.displacement.resize(3, layout_.node_count);
      table("node", layout_.node_count, 0, [&](int n, const std::array<double, 6>& row) {
        state.displacement.col(n) << row[0], row[1], row[2];
      });
      state.displacement *= layout_.units.length;
      if (!next_line_with_words()) throw Bad{"the file ends before the stresses"};
      need_level(heading("stresses"), level);
      state.stress.resize(6, layout_.points * layout_.tet_count);
      table("element", layout_.tet_count, layout_.points,
            [&](int e, const std::array<double, 6>& row) {
              // CalculiX: xx yy zz xy xz yz. Ours: xx yy zz xy yz zx.
              state.stress.col(e) << row[0], row[1], row[2], row[3], row[5], row[4];
            });
      state.stress *= layout_.units.stress;
      states.push_back(std::move(state));
    }
    return states;
  }

 private:
  bool next_line() {
    if (!std::getline(in_, line_)) return false;
    ++line_number_;
    return true;
  }

  bool next_line_with_words() {
    while (next_line()) {
      if (line_.find_first_not_of(" \t\r") != std::string::npos) return true;
    }
    return false;
  }

  // "... for set NAME and time  0.1000000E+00": the time.
  double heading(std::string_view quantity) {
    const std::string_view line = line_;
    const std::size_t begin = line.find_first_not_of(' ');
    const std::size_t at = line.rfind(" time ");
    double time = 0;
    std::size_t count = 0;
    if (at != std::string_view::npos && line.substr(begin).starts_with(quantity)) {
      const auto words = split<1>(line.substr(at + 6), count);
      if (count == 1 && parse_fortran(words[0], time)) return time;
    }
    throw Bad{fmt::format("'{}' where the heading of the {} should be", shown(line_), quantity)};
  }

  static void need_level(double time, double level) {
    // Seven digits are printed; levels nearer to each other than that make no sense.
    if (std::abs(time - level) <= 1e-6 * level) return;
    throw Bad{fmt::format("a result at time {} where level {} should be", time, level)};
  }

  // Lines of: index and 3 numbers (points 0); or index, number of the integration point and 6
  // numbers, a line for each of the points. `take` gets the column: index, or points index + point.
  template <class Take>
  void table(std::string_view what, int count, int points, const Take& take) {
    const std::size_t indices = points == 0 ? 1 : 2, values = points == 0 ? 3 : 6;
    const int per_index = std::max(points, 1), rows = per_index * count;
    std::vector<bool> seen(static_cast<std::size_t>(rows));
    for (int row = 0; row < rows; ++row) {
      if (!(row == 0 ? next_line_with_words() : next_line())) {
        throw Bad{fmt::format("the file ends after {} of {} lines of {}s", row, rows, what)};
      }
      std::size_t found = 0;
      const auto words = split<8>(line_, found);
      if (found != indices + values) {
        throw Bad{fmt::format("'{}' has {} columns, a line of a {} has {}", shown(line_), found,
                              what, indices + values)};
      }
      int index = 0, point = 1;
      if (!parse_index(words[0], index) || index < 1 || index > count) {
        throw Bad{fmt::format("{} number '{}'; there are {}", what, shown(words[0]), count)};
      }
      if (points > 0 && (!parse_index(words[1], point) || point < 1 || point > points)) {
        throw Bad{
            fmt::format("integration point '{}'; an element has {}", shown(words[1]), points)};
      }
      const int column = per_index * (index - 1) + point - 1;
      if (seen[static_cast<std::size_t>(column)]) {
        throw Bad{fmt::format("{} {} comes twice", what, index)};
      }
      seen[static_cast<std::size_t>(column)] = true;
      std::array<double, 6> numbers{};
      for (std::size_t k = 0; k < values; ++k) {
        if (!parse_fortran(words[indices + k], numbers[k])) {
          throw Bad{fmt::format("'{}' is not a finite number", shown(words[indices + k]))};
        }
      }
      take(column, numbers);
    }
  }

  // At most 60 characters, printable.
  static std::string shown(std::string_view text) {
    std::string out(text.substr(0, 60));
    for (char& c : out) {
      if (std::isprint(static_cast<unsigned char>(c)) == 0) c = '?';
    }
    return out;
  }

  std::istream& in_;
  const CalculixDatLayout& layout_;
  std::string line_;
  long line_number_ = 0;
};

}  // namespace

CalculixUnits calculix_units(const SolidModel& model) {
  const auto power_of_ten = [](double value) {
    return std::pow(10.0, std::round(std::log10(value)));
  };
  const double edge = std::cbrt(tet_volumes(model.mesh).mean());
  return {.length = power_of_ten(edge / 1e3),
          .stress = power_of_ten(lame_constants(model.material).mu / 1e3)};
}

std::string calculix_deck(const SolidModel& model, const Matrix3Xd& full_load,
                          std::span<const double> levels, double tolerance) {
  check_input(model, full_load, levels);
  PALPABLE_EXPECT(tolerance > 0.0 && tolerance < 1.0, "the tolerance is between 0 and 1");
  const CalculixUnits units = calculix_units(model);
  const double last = levels.back();
  double smallest_step = levels.front(), before = 0.0;
  for (const double level : levels) {
    smallest_step = std::min(smallest_step, level - before);
    before = level;
  }

  std::string deck;
  const auto out = std::back_inserter(deck);
  fmt::format_to(out, "** Written by Palpable. Lengths in {:g} m, stresses in {:g} Pa.\n",
                 units.length, units.stress);
  deck += "** Time is the load level.\n";
  deck += "*NODE, NSET=NALL\n";
  for (int n = 0; n < model.mesh.node_count(); ++n) {
    const Eigen::Vector3d X = model.mesh.nodes.col(n) / units.length;
    fmt::format_to(out, "{},{},{},{}\n", n + 1, number(X[0]), number(X[1]), number(X[2]));
  }
  const bool quadratic = model.mesh.is_quadratic();
  fmt::format_to(out, "*ELEMENT, TYPE={}, ELSET=EALL\n", quadratic ? "C3D10" : "C3D4");
  for (int e = 0; e < model.mesh.tet_count(); ++e) {
    fmt::format_to(out, "{}", e + 1);
    for (const int v : model.mesh.tets.col(e)) fmt::format_to(out, ",{}", v + 1);
    if (quadratic) {
      for (const int v : model.mesh.edge_nodes.col(e)) fmt::format_to(out, ",{}", v + 1);
    }
    deck += '\n';
  }
  // What is in no group is BODY, the groups are GROUP1 and so on.
  const std::vector<int> group_of = material_groups(model);
  for (int g = -1; g < static_cast<int>(model.groups.size()); ++g) {
    if (std::find(group_of.begin(), group_of.end(), g) == group_of.end()) continue;
    const std::string name = g < 0 ? "BODY" : fmt::format("GROUP{}", g + 1);
    const Material& material =
        g < 0 ? model.material : model.groups[static_cast<std::size_t>(g)].material;
    fmt::format_to(out, "*ELSET, ELSET={}\n", name);
    for (std::size_t e = 0; e < group_of.size(); ++e) {
      if (group_of[e] == g) fmt::format_to(out, "{}\n", e + 1);
    }
    deck += material_section(material, name, units.stress);
    fmt::format_to(out, "*SOLID SECTION, ELSET={0}, MATERIAL={0}\n", name);
  }
  deck += "*BOUNDARY\n";
  const std::vector<HeldComponent> held = held_components(model);
  for (const HeldComponent& h : held) {
    fmt::format_to(out, "{0},{1},{1}\n", h.at / 3 + 1, h.at % 3 + 1);
  }
  deck += "*TIME POINTS, NAME=LEVELS\n";
  for (const double level : levels) fmt::format_to(out, "{}\n", number(level));

  // Loads and displacements are given at the end of the step and grow linearly with time. An
  // increment of a thousandth of the smallest step means that there is no way on.
  fmt::format_to(out, "*STEP, NLGEOM, INC=1000000\n*STATIC\n{},{},{}\n", number(levels.front()),
                 number(last), number(1e-3 * smallest_step));
  // R_n, C_n, q_0, q_u, R_p, eps, C_eps, R_l. C_n = 1: the size of the last correction decides
  // nothing. R_l: a residual so small would end the iteration whatever the correction.
  fmt::format_to(out, "*CONTROLS, PARAMETERS=FIELD\n{0:g},1.,,,{0:g},,,{1:g}\n", tolerance,
                 1e-4 * tolerance);
  // I_0, I_R, I_P, I_C: a tight tolerance takes more iterations before divergence is suspected
  // (from I_0 on), slow convergence (I_R) and failure (I_C).
  deck += "*CONTROLS, PARAMETERS=TIME INCREMENTATION\n8,16,9,24\n";
  deck += "*BOUNDARY\n";
  Matrix3Xd load = full_load;
  for (const HeldComponent& h : held) {
    load.reshaped()[h.at] = 0.0;  // moves nothing
    if (h.displacement == 0.0) continue;
    fmt::format_to(out, "{0},{1},{1},{2}\n", h.at / 3 + 1, h.at % 3 + 1,
                   number(last * h.displacement / units.length));
  }
  deck += "*CLOAD\n";
  for (Eigen::Index at = 0; at < load.size(); ++at) {
    const double force = load.reshaped()[at];
    if (force == 0.0) continue;
    fmt::format_to(out, "{},{},{}\n", at / 3 + 1, at % 3 + 1, number(last * force / units.force()));
  }
  // .dat has seven digits, .frd would have six.
  deck += "*NODE PRINT, NSET=NALL, TIME POINTS=LEVELS\nU\n";
  deck += "*EL PRINT, ELSET=EALL, TIME POINTS=LEVELS\nS\n";
  deck += "*END STEP\n";
  return deck;
}

Result<std::vector<CalculixState>> read_calculix_dat(std::istream& dat,
                                                     const CalculixDatLayout& layout,
                                                     std::string_view name) {
  DatReader reader(dat, layout);
  try {
    return reader.read();
  } catch (const DatReader::Bad& bad) {
    return Problem{fmt::format("{}:{}: {}", name, reader.line_number(), bad.what)};
  }
}

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

CalculixRun solve_with_calculix(const SolidModel& model, const Matrix3Xd& full_load,
                                std::span<const double> levels, const CalculixSettings& settings,
                                const Progress& progress) {
  const std::string deck = calculix_deck(model, full_load, levels, settings.tolerance);
  const std::optional<fs::path> program = find_calculix(settings.program);
  if (!program) {
    throw Error(fmt::format(
        "CalculiX ({}) is not there or cannot be run; on Debian: apt install calculix-ccx",
        settings.program));
  }
  std::optional<TemporaryFolder> temporary;
  if (settings.folder.empty()) temporary.emplace();
  const fs::path folder = fs::absolute(temporary ? temporary->path() : settings.folder);
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed) throw Error(fmt::format("{}: cannot be made: {}", folder.string(), failed.message()));
  const auto file = [&](std::string_view ending) {
    return folder / fmt::format("{}.{}", kJob, ending);
  };
  for (const std::string_view ending : {"dat", "sta", "frd", "cvg", "log"}) {
    fs::remove(file(ending), failed);  // of an earlier run
  }
  {
    std::ofstream inp(file("inp"), std::ios::binary);
    inp << deck << std::flush;
    if (!inp) {
      throw Error(fmt::format("{}: cannot be written (is the disk full?)", file("inp").string()));
    }
  }

  const auto level_count = static_cast<double>(levels.size());
  const auto show = [&] {
    const StaSummary sta = read_sta(file("sta"));
    // Between two levels, the share of the way.
    const auto above = std::upper_bound(levels.begin(), levels.end(), sta.level * (1.0 + 1e-6));
    double done = static_cast<double>(above - levels.begin());
    if (above != levels.end()) {
      const double below = above == levels.begin() ? 0.0 : *(above - 1);
      done += std::max(0.0, (sta.level - below) / (*above - below));
    }
    report(progress,
           {.task = "CalculiX",
            .done = std::min(done, level_count),
            .total = level_count,
            .note = fmt::format("{} increments, {} iterations", sta.increments, sta.iterations)});
  };

  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  Child child(*program, kJob, folder, file("log"));
  Clock::time_point shown = start;
  // Short runs are not kept waiting, long ones not disturbed.
  for (auto pause = std::chrono::milliseconds(2); !child.ended();
       pause = std::min(2 * pause, std::chrono::milliseconds(100))) {
    std::this_thread::sleep_for(pause);
    if (Clock::now() - shown > std::chrono::milliseconds(300)) {
      show();
      shown = Clock::now();
    }
  }
  CalculixRun run;
  run.wall_seconds = std::chrono::duration<double>(Clock::now() - start).count();
  run.cpu_seconds = child.cpu_seconds();
  const StaSummary sta = read_sta(file("sta"));
  run.increments = sta.increments;
  run.iterations = sta.iterations;
  run.last_level = sta.level;

  const std::string said = calculix_error(read_text(file("log")));
  const int status = child.status();
  // Whoever keeps the folder can look further.
  const std::string where =
      temporary ? std::string() : fmt::format(" (see {})", file("log").string());
  if (WIFSIGNALED(status)) {
    throw Error(
        fmt::format("CalculiX was ended by signal {} ({}) at level {:.4g}; out of memory?{}",
                    WTERMSIG(status), ::strsignal(WTERMSIG(status)), sta.level, where));
  }
  // How ccx says that the path does not go on, as opposed to a deck that it refuses.
  const bool gave_up = std::any_of(kGaveUp.begin(), kGaveUp.end(), [&](std::string_view words) {
    return said.find(words) != std::string::npos;
  });
  if (!gave_up && (WEXITSTATUS(status) != 0 || !said.empty())) {
    throw Error(fmt::format("CalculiX failed: {}{}",
                            said.empty() ? fmt::format("exit code {}", WEXITSTATUS(status)) : said,
                            where));
  }

  std::ifstream dat(file("dat"), std::ios::binary);
  const CalculixDatLayout layout{.node_count = model.mesh.node_count(),
                                 .tet_count = model.mesh.tet_count(),
                                 .points = model.mesh.is_quadratic() ? 4 : 1,
                                 .levels = {levels.begin(), levels.end()},
                                 .units = calculix_units(model)};
  run.states = value_or_throw(read_calculix_dat(dat, layout, file("dat").string()));
  run.complete = run.states.size() == levels.size();
  if (!run.complete && !gave_up) {
    throw Error(fmt::format("CalculiX ended well but printed {} of {} levels{}", run.states.size(),
                            levels.size(), where));
  }
  if (!run.complete) {
    run.why_stopped = fmt::format(
        "load level {:.6g} was not reached, the last increment that converged ended at {:.6g}: "
        "CalculiX: {}",
        levels[run.states.size()], run.last_level, said);
  }
  show();
  return run;
}

}  // namespace palpable

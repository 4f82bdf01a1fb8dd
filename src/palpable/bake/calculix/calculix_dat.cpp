#include "palpable/bake/calculix/calculix_dat.h"

#include "palpable/common/base/text_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <istream>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

namespace palpable {
namespace {

// Fortran prints three digits of exponent without the E: 1.234567-101.
bool parse_fortran(std::string_view word, double& value) {
  if (const std::optional<double> plain = to_number(word)) {
    value = *plain;
    return true;
  }
  if (word.starts_with('+')) word.remove_prefix(1);
  const std::size_t sign = word.find_first_of("+-", 1);
  if (sign == std::string_view::npos || word.find_first_of("eE") != std::string_view::npos) {
    return false;
  }
  const std::string with_e = fmt::format("{}E{}", word.substr(0, sign), word.substr(sign));
  const char* const end = with_e.data() + with_e.size();
  const auto [stop, code] = std::from_chars(with_e.data(), end, value);
  // A number below the smallest double is read as zero.
  if (code == std::errc::result_out_of_range && word[sign] == '-') {
    value = 0.0;
    return true;
  }
  return code == std::errc() && stop == end && std::isfinite(value);
}

bool parse_index(std::string_view word, int& value) {
  const auto [stop, code] = std::from_chars(word.data(), word.data() + word.size(), value);
  return code == std::errc() && stop == word.data() + word.size();
}

// The first words of a line, at most `Most`; `count` is the number of all its words.
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

// Reads a .dat file line by line. It throws Bad, which read_calculix_dat() turns into a Problem.
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
    // ccx prints seven digits, so levels nearer to each other than that cannot be told apart.
    if (std::abs(time - level) <= 1e-6 * level) return;
    throw Bad{fmt::format("a result at time {} where level {} should be", time, level)};
  }

  // Reads the rows of `count` nodes or elements. Without integration points (points = 0) a row
  // holds an index and 3 numbers; with them there is a row for each point, with the index, the
  // number of the point and 6 numbers. Calls store(column, numbers) for each row, where the column,
  // from 0, is that of the node, or of the element's integration point.
  template <class Store>
  void table(std::string_view what, int count, int points, const Store& store) {
    const std::size_t indices = points == 0 ? 1 : 2, values = points == 0 ? 3 : 6;
    const int per_index = std::max(points, 1), rows = per_index * count;
    std::vector<bool> seen(rows);
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
      if (seen[column]) { throw Bad{fmt::format("{} {} comes twice", what, index)}; }
      seen[column] = true;
      std::array<double, 6> numbers{};
      for (std::size_t k = 0; k < values; ++k) {
        if (!parse_fortran(words[indices + k], numbers[k])) {
          throw Bad{fmt::format("'{}' is not a finite number", shown(words[indices + k]))};
        }
      }
      store(column, numbers);
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

// The table is preceded by "E I G E N V A L U E   O U T P U T" and its heading. Each row has a
// mode's number, its eigenvalue, its frequency in radians and cycles per unit of time, and an
// imaginary part.
Result<std::vector<double>> read_calculix_eigenvalues(std::istream& dat, int modes,
                                                      std::string_view name) {
  std::vector<double> eigenvalues;
  std::string line;
  bool in_table = false;
  int number = 0;
  while (static_cast<int>(eigenvalues.size()) < modes && std::getline(dat, line)) {
    ++number;
    if (line.find("E I G E N V A L U E") != std::string::npos) in_table = true;
    std::size_t count = 0;
    const auto words = split<5>(line, count);
    int mode = 0;
    if (!in_table || count == 0 || !parse_index(words[0], mode)) continue;
    double value = 0;
    if (count != 5 || mode != static_cast<int>(eigenvalues.size()) + 1 ||
        !parse_fortran(words[1], value) ||
        (!eigenvalues.empty() && value < eigenvalues.back() * (1 - 1e-6))) {
      return Problem{
          fmt::format("{}:{}: no row of eigenvalue {}", name, number, eigenvalues.size() + 1)};
    }
    eigenvalues.push_back(value);
  }
  if (static_cast<int>(eigenvalues.size()) < modes) {
    return Problem{
        fmt::format("{}: ends after {} of {} eigenvalues", name, eigenvalues.size(), modes)};
  }
  return eigenvalues;
}

}  // namespace palpable

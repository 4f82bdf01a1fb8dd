#include "apps/common/command_line.h"

#include "apps/common/help_format.h"
#include "apps/common/printing.h"
#include "palpable/common/base/cpu_time.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/nearest_word.h"
#include "palpable/common/base/quantity.h"
#include "palpable/common/base/standard_streams.h"
#include "palpable/common/base/text_numbers.h"
#include "palpable/common/base/this_machine.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <new>
#include <optional>
#include <set>
#include <utility>

namespace palpable::app {
namespace {

constexpr const char* kHelpAll = "--help-all";

// The name of the check by which Option::further_words() stores its rule at the option. CLI11 does
// not apply it, because it is not active.
constexpr const char* kFurtherWord = "further word";

// Whether a word may follow the first word of this option. Nothing: the option has no such rule.
std::optional<bool> may_follow(CLI::Option& option, const std::string& word) {
  try {
    CLI::Validator rule = *option.get_validator(kFurtherWord);
    return rule.active()(word).empty();
  } catch (const CLI::OptionNotFound&) { return std::nullopt; }
}

// Writes the name of an option before each of its further words: "--set a=1 b=2 BODY" becomes
// "--set a=1 --set b=2 BODY". Otherwise CLI11 would read BODY as another value of --set.
void repeat_names_of_options(CLI::App& app, std::vector<const char*>& words) {
  const std::vector<CLI::App*> commands = app.get_subcommands({});
  const auto command = std::find_if(commands.begin(), commands.end(), [&](const CLI::App* one) {
    return words.size() > 1 && one->get_name() == words[1];
  });
  if (command == commands.end()) return;
  std::vector<const char*> repeated;
  const char* name = nullptr;      // as written, of the option whose words are read; null: of none
  CLI::Option* current = nullptr;  // that option
  for (const char* word : words) {
    const bool is_first = !repeated.empty() && repeated.back() == name;
    CLI::Option* option = word[0] == '-' ? (*command)->get_option_no_throw(word) : nullptr;
    if (option != nullptr) {
      name = word;
      current = option;
    } else if (name != nullptr && !is_first) {
      if (may_follow(*current, word).value_or(false)) {
        repeated.push_back(name);
      } else {
        name = nullptr;
      }
    }
    repeated.push_back(word);
  }
  words = std::move(repeated);
}

// The innermost subcommand that the user named.
const CLI::App* innermost(const CLI::App& app) {
  const CLI::App* inner = &app;
  while (!inner->get_subcommands().empty()) inner = inner->get_subcommands().back();
  return inner;
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

std::vector<std::string> subcommand_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* sub : app.get_subcommands({})) names.push_back(sub->get_name());
  return names;
}

std::string full_name(const CLI::App& app) {
  const CLI::App* parent = app.get_parent();
  return parent == nullptr ? app.get_name() : full_name(*parent) + " " + app.get_name();
}

// The message of an error. For a missing argument that may also be given as an option, CLI11's own
// message names only the option; this one names the argument and shows where it goes.
std::string what_is_wrong(const CLI::ParseError& error, const CLI::App& command) {
  std::string text = error.what();
  for (const CLI::Option* option : command.get_options()) {
    if (!option->get_positional() || option->get_lnames().empty()) continue;
    if (text == fmt::format("--{} is required", option->get_lnames().front())) {
      return fmt::format("{} is missing: {} {}", option->get_name(true), full_name(command),
                         option->get_type_name());
    }
  }
  return text;
}

// The option of an older version, if it was one of the innermost command.
const OldSpelling* old_spelling(const CLI::App& command, std::string_view option) {
  for (const OldSpelling& old : old_spellings()) {
    const bool of_command = old.command.empty() || old.command == command.get_name();
    if (of_command && old.option == option) return &old;
  }
  return nullptr;
}

std::string unexpected_argument(const CLI::App& app) {
  const CLI::App* inner = innermost(app);
  const std::vector<std::string> rest = app.remaining(true);
  const std::string word =
      rest.empty() ? std::string() : rest.front().substr(0, rest.front().find('='));
  const bool is_option = !word.empty() && word.front() == '-';
  if (const OldSpelling* old = is_option ? old_spelling(*inner, word) : nullptr) {
    return fmt::format("'{}' was its name in 0.1: write {}, see {} --help", word, old->now,
                       full_name(*inner));
  }
  const bool wants_command = !is_option && !subcommand_names(*inner).empty();
  const std::string guess =
      nearest_word(word, is_option ? option_names(*inner) : subcommand_names(*inner));
  return fmt::format("{} '{}'{}, see {} --help",
                     is_option       ? "unknown option"
                     : wants_command ? "unknown command"
                                     : "unexpected argument",
                     word, guess.empty() ? "" : fmt::format(": did you mean '{}'?", guess),
                     full_name(*inner));
}

// Used instead of CLI11's range, whose message prints the largest double in full.
std::string why_negative(const std::string& text) {
  const std::optional<double> number = to_number(text);
  return number && *number >= 0.0 ? "" : fmt::format("must be 0 or more, not '{}'", text);
}
std::string why_not_positive(const std::string& text) {
  const std::optional<double> number = to_number(text);
  return number && *number > 0.0 ? "" : fmt::format("must be above 0, not '{}'", text);
}

// Rejects NaN, which passes CLI11's ranges because it is neither below nor above a number.
std::string why_no_number(const std::string& text) {
  if (to_number(text)) return {};
  return fmt::format("{} is no number that is finite", text);
}

bool is_in(LengthRange range, double metres) {
  return metres >= range.least && metres <= range.most;
}

// Suggests the units with which the number is in the range: options of 0.1 were in mm or in m.
std::string why_no_unit(const std::string& number, LengthRange range) {
  std::string units;
  for (const char* unit : {"mm", "m"}) {
    const std::optional<double> metres = to_quantity(number + unit, Quantity::kLength);
    if (!metres || !is_in(range, *metres)) continue;
    units += fmt::format("{}{}{}", units.empty() ? "" : " or ", number, unit);
  }
  return fmt::format("{} has no unit: write {}", number,
                     units.empty() ? "a length such as " + length_text(range.least) : units);
}

std::string why_no_length(const std::string& text, LengthRange range) {
  const std::optional<double> metres = to_quantity(text, Quantity::kLength);
  if (!metres) {
    return to_number(text) ? why_no_unit(text, range)
                           : fmt::format("'{}' is no length, such as 7mm; its units are {}", text,
                                         fmt::join(length_unit_names(), ", "));
  }
  if (is_in(range, *metres)) return {};
  return fmt::format("{} is not between {} and {}", text, length_text(range.least),
                     length_text(range.most));
}

// Flushes stdout; prints an error if that fails. @return the exit code
int success_if_printed() {
  const std::string trouble = flush_standard_output();
  if (!trouble.empty()) print_error(trouble);
  return trouble.empty() ? 0 : 1;
}

}  // namespace

BenchCall::BenchCall(int count, char** words) : name("palpable bench"), argc(count), argv(words) {
  if (count > 1 && std::string_view(words[1]) == "bench") {
    --argc;
    ++argv;
  } else if (count > 0) {
    name = std::filesystem::path(words[0]).filename().string();
  }
}

void print_error(std::string_view message) {
  std::string line;
  for (const char c : message) {
    // A message quotes words of files, which must not steer the terminal.
    const bool steers = (c >= '\0' && c < ' ') || c == '\x7f';
    if (c == '\n') {
      line += "; ";
    } else {
      line += steers ? '?' : c;
    }
  }
  while (line.ends_with("; ")) line.resize(line.size() - 2);
  // Not fmt::print(), which throws when the terminal was closed.
  std::fputs(fmt::format("palpable: {}\n", line).c_str(), stderr);
}

Option Option::required() { return Option(option_->required()); }

Option Option::type_name(const std::string& name) { return Option(option_->type_name(name)); }

Option Option::show_default() { return Option(option_->capture_default_str()); }

Option Option::default_is(const std::string& words) { return Option(option_->default_str(words)); }

Option Option::in_range(int least, int most) {
  return Option(option_->check(CLI::Range(least, most)));
}

Option Option::in_range(double least, double most) {
  return Option(option_->check(CLI::Range(least, most)));
}

Option Option::in_range(std::uint64_t least, std::uint64_t most) {
  return Option(option_->check(CLI::Range(least, most)));
}

Option Option::positive() {
  return Option(option_->check(CLI::Validator(why_not_positive, "POSITIVE")));
}

Option Option::not_negative() {
  return Option(option_->check(CLI::Validator(why_negative, "NONNEGATIVE")));
}

Option Option::one_of(const std::vector<std::string>& words) {
  return Option(option_->check(CLI::IsMember(words)));
}

Option Option::existing_path() { return Option(option_->check(CLI::ExistingPath)); }

Option Option::existing_folder() { return Option(option_->check(CLI::ExistingDirectory)); }

Option Option::words(int fewest, int most) {
  // One word: what follows it is an argument of the command.
  return Option(option_->expected(fewest, most)->allow_extra_args(most > 1));
}

Option Option::further_words(bool (*fits)(const std::string& word)) {
  CLI::Validator rule(
      [fits](const std::string& word) { return std::string(fits(word) ? "" : "does not fit"); }, "",
      kFurtherWord);
  // CLI11 heeds allow_extra_args() only where the number of words has no end.
  return Option(option_->check(rule.active(false))->expected(-1)->allow_extra_args(false));
}

Option Option::split_at_commas() { return Option(option_->delimiter(',')); }

Option Option::excludes(const Option& other) { return Option(option_->excludes(other.option_)); }

Option Option::excludes(const std::string& name) { return Option(option_->excludes(name)); }

Command Command::add_subcommand(const std::string& name, const std::string& what) {
  return Command(app_->add_subcommand(name, what)->group(group_.empty() ? "Commands" : group_));
}

void Command::require_subcommand() { app_->require_subcommand(1); }

void Command::begin_group(const std::string& heading) { group_ = heading; }

void Command::begin_expert_group(const std::string& heading) {
  group_ = kExpertMark + heading;
  if (app_->get_option_no_throw(kHelpAll) == nullptr) {
    app_->add_flag(kHelpAll)->description("Print this help with the options of experts, and exit");
  }
}

Option Command::placed(CLI::Option* option) {
  if (!group_.empty()) option->group(group_);
  return Option(option);
}

template <OptionValue T>
Option Command::add_option(const std::string& names, T& value, const std::string& what) {
  CLI::Option* option = app_->add_option(names, value, what);
  if constexpr (std::same_as<T, std::filesystem::path>) option->type_name("FILE");
  if constexpr (std::same_as<T, double> || std::same_as<T, std::optional<double>> ||
                std::same_as<T, std::vector<double>>) {
    option->check([](const std::string& text) { return why_no_number(text); }, "");
  }
  return placed(option);
}

template Option Command::add_option(const std::string&, std::string&, const std::string&);
template Option Command::add_option(const std::string&, std::filesystem::path&, const std::string&);
template Option Command::add_option(const std::string&, int&, const std::string&);
template Option Command::add_option(const std::string&, unsigned&, const std::string&);
template Option Command::add_option(const std::string&, double&, const std::string&);
template Option Command::add_option(const std::string&, std::uint64_t&, const std::string&);
template Option Command::add_option(const std::string&, std::optional<double>&, const std::string&);
template Option Command::add_option(const std::string&, std::vector<int>&, const std::string&);
template Option Command::add_option(const std::string&, std::vector<double>&, const std::string&);
template Option Command::add_option(const std::string&, std::vector<std::string>&,
                                    const std::string&);

Option Command::add_option(const std::string& name,
                           std::function<std::string(const std::vector<std::string>&)> read,
                           const std::string& what) {
  return placed(app_->add_option_function<std::vector<std::string>>(
      name,
      [name, read = std::move(read)](const std::vector<std::string>& words) {
        if (const std::string why = read(words); !why.empty()) {
          throw CLI::ValidationError(name, why);
        }
      },
      what));
}

Option Command::add_flag(const std::string& names, bool& value, const std::string& what) {
  return placed(app_->add_flag(names, value, what));
}

Option Command::add_length(const std::string& names, std::optional<double>& metres,
                           const std::string& what, LengthRange range) {
  return add_length(
      names, [&metres](double given) { metres = given; }, metres.value_or(0), what, range);
}

Option Command::add_length(const std::string& names, double& metres, const std::string& what,
                           LengthRange range) {
  return add_length(
      names, [&metres](double given) { metres = given; }, metres, what, range);
}

Option Command::add_length(const std::string& names, const std::function<void(double)>& set,
                           double present, const std::string& what, LengthRange range) {
  CLI::Option* option = app_->add_option_function<std::string>(
      names, [set](const std::string& text) { set(to_quantity(text, Quantity::kLength).value()); },
      what);
  option->type_name("LENGTH")->check(
      [range](const std::string& text) { return why_no_length(text, range); }, "");
  if (present > 0) option->default_str(length_text(present));
  return placed(option);
}

Option Command::add_json(bool& json) {
  return placed(app_->add_flag_callback(
      "--json",
      [&json] {
        json = true;
        reserve_stdout_for_json();
      },
      "Print the result as one JSON object on stdout"));
}

void Command::set_from_file(const std::vector<FileOption>& options) {
  std::vector<std::pair<CLI::Option*, const FileOption*>> wanted;
  for (const FileOption& one : options) {
    CLI::Option* option = app_->get_option_no_throw("--" + one.name);
    if (option == nullptr) {
      const std::string guess = nearest_word("--" + one.name, option_names(*app_));
      throw Error(
          fmt::format("{}: '{}' is no option of {}{}", one.where, one.name, full_name(*app_),
                      guess.empty() ? "" : fmt::format(": did you mean '{}'?", guess.substr(2))));
    }
    const std::set<CLI::Option*> others = option->get_excludes();
    const bool given = option->count() > 0 ||
                       std::any_of(others.begin(), others.end(),
                                   [](const CLI::Option* other) { return other->count() > 0; });
    if (!given) wanted.emplace_back(option, &one);
  }
  for (const auto& [option, one] : wanted) {
    for (const CLI::Option* other : option->get_excludes()) {
      if (other->count() > 0) {
        throw Error(fmt::format("{}: '{}' and '{}' exclude each other", one->where, one->name,
                                other->get_lnames().front()));
      }
    }
    set_from_file(*option, *one);
  }
}

void Command::set_from_file(CLI::Option& option, const FileOption& from) {
  if (is_flag(option)) {
    const bool value = from.words == std::vector<std::string>{"true"};
    if (!value && from.words != std::vector<std::string>{"false"}) {
      throw Error(fmt::format("{}: '{}' must be true or false", from.where, from.name));
    }
    if (!value) return;
  }
  try {
    for (const std::string& word : from.words) option.add_result(word);
    option.run_callback();
  } catch (const CLI::ParseError& error) {
    throw Error(fmt::format("{}: {}", from.where, error.what()));
  }
}

std::vector<Command::GivenOption> Command::given_options() const {
  std::vector<GivenOption> given;
  for (const CLI::Option* option : std::as_const(*app_).get_options()) {
    if (option->count() == 0 || option->get_positional() || option->get_lnames().empty()) continue;
    given.push_back({option->get_lnames().front(), option->results(), is_flag(*option)});
  }
  return given;
}

void Command::footer(const std::string& text) { app_->footer(text); }

void Command::callback(std::function<void()> run) { app_->callback(std::move(run)); }

CommandLine::CommandLine(const std::string& what, const std::string& name,
                         const std::string& version)
    : CommandLine(std::make_unique<CLI::App>(what, name)) {
  app().formatter(help_format());
  app().set_version_flag("--version", version, "Print the version and exit");
  app().set_help_flag("-h,--help", "Print this help and exit");
  app().fallthrough();  // commands take the options of the program, too
  app().add_flag_callback(
      "-q,--quiet", [] { set_verbosity(Verbosity::kQuiet); },
      "Print results, errors and warnings only: no progress, no notes");
  app().add_flag_callback(
      "-v,--verbose", [] { set_verbosity(Verbosity::kVerbose); },
      "Also print time and memory at the end, and what video libraries report");
}

CommandLine::CommandLine(std::unique_ptr<CLI::App> app)
    : Command(app.get()), owned_(std::move(app)) {}

CommandLine::~CommandLine() = default;

int CommandLine::run(int argc, const char* const* argv) {
  prepare_standard_streams();
  CLI::App& app = this->app();
  std::vector<const char*> words(argv, argv + argc);
  if (argc > 1 && std::string_view(argv[1]) == "help") {  // help live = live --help
    words.erase(words.begin() + 1);
    if (words.size() == 2 && std::string_view(words[1]) == "--reference") {
      std::fputs(reference_json().c_str(), stdout);
      return success_if_printed();
    }
    words.push_back("--help");
  }
  for (const char*& word : words) {
    if (std::string_view(word) != kHelpAll) continue;
    for (CLI::App* sub : app.get_subcommands({})) sub->formatter(help_format(true));
    word = "--help";
  }
  repeat_names_of_options(app, words);
  argc = static_cast<int>(words.size());
  argv = words.data();
  // An unknown word is reported first; CLI11 would report that a command is missing.
  if (argc > 1 && argv[1][0] != '-') {
    const std::vector<std::string> commands = subcommand_names(app);
    if (std::find(commands.begin(), commands.end(), argv[1]) == commands.end()) {
      const std::string guess = nearest_word(argv[1], commands);
      print_error(fmt::format("unknown command '{}'{}, see {} --help", argv[1],
                              guess.empty() ? "" : fmt::format(": did you mean '{}'?", guess),
                              app.get_name()));
      return 1;
    }
  }
  try {
    const auto begin = std::chrono::steady_clock::now();
    app.parse(argc, argv);
    if (verbosity() == Verbosity::kVerbose) {
      const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
      print_note("{:.2f} s, {:.2f} s of processor time, at most {:.0f} MB of memory", taken.count(),
                 process_cpu_seconds(), peak_memory() / 1e6);
    }
    return success_if_printed();
  } catch (const CLI::Success& success) {  // --help, --version: printed by CLI11 on stdout
    app.exit(success);
    return success_if_printed();
  } catch (const CLI::ExtrasError&) {
    print_error(unexpected_argument(app));
  } catch (const CLI::ParseError& error) {
    // An unknown option is reported before a missing one, which it explains: "--ouput" before
    // "--out is required".
    const std::vector<std::string> rest = app.remaining(true);
    const bool unknown = std::any_of(rest.begin(), rest.end(),
                                     [](const std::string& word) { return word.starts_with("-"); });
    print_error(unknown ? unexpected_argument(app)
                        : fmt::format("{}, see {} --help", what_is_wrong(error, *innermost(app)),
                                      full_name(*innermost(app))));
  } catch (const std::bad_alloc&) {
    print_error("there is not enough memory for this");
  } catch (const std::exception& error) { print_error(error.what()); }
  return 1;
}

std::string CommandLine::reference_json() const {
  Json all = {{"name", app().get_name()},
              {"what", app().get_description()},
              {"footer", app().get_footer()},
              {"commands", Json::array()}};
  Json commands = Json::array();
  for (const CLI::App* sub : app().get_subcommands({})) {
    Json command = {{"name", sub->get_name()},
                    {"what", sub->get_description()},
                    {"footer", sub->get_footer()},
                    {"options", Json::array()}};
    Json options = Json::array();
    for (const CLI::Option* option : sub->get_options()) {
      const OptionWords words = words_of(*option);
      const std::string group = option->get_group();
      const bool expert = group.starts_with(kExpertMark);
      std::vector<std::string> names;
      for (const std::string& name : option->get_snames()) names.push_back("-" + name);
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
      // "source" of an argument that may also be given as --source.
      if (option->get_positional()) names.insert(names.begin(), option->get_name(true));
      options.push_back({{"names", names},
                         {"value", words.value},
                         {"several", words.several},
                         {"positional", option->get_positional()},
                         {"limits", words.limits},
                         {"choices", words.choices},
                         {"default", words.usual},
                         {"what", option->get_description()},
                         {"heading", expert ? group.substr(1) : group},
                         {"expert", expert}});
    }
    command["options"] = std::move(options);
    commands.push_back(std::move(command));
  }
  all["commands"] = std::move(commands);
  return all.dump(1) + "\n";
}

bool has_equals_sign(const std::string& word) { return word.find('=') != std::string::npos; }

std::string length_text(double metres) {
  if (metres >= 1) return fmt::format("{}m", metres);
  // 7 mm is 0.007 m, which is not 7e-3 to the last bit: rounded to what a person would write.
  return fmt::format("{:.6g}mm", metres * 1e3);
}

std::optional<std::array<int, 2>> parse_extent(std::string_view text) {
  const std::size_t times = text.find('x');
  if (times == std::string_view::npos) return std::nullopt;
  std::array<int, 2> sides{};
  const std::array words{text.substr(0, times), text.substr(times + 1)};
  for (std::size_t i = 0; i < 2; ++i) {
    const std::optional<long long> side = to_whole_number(words[i]);
    if (!side || *side < 1 || *side > kLongestSide) return std::nullopt;
    sides[i] = static_cast<int>(*side);
  }
  return sides;
}

Option add_threads(Command command, int& threads, const std::string& what) {
  return command.add_option("--threads", threads, what + "; 0: one for each core")
      .in_range(0, 4096)
      .show_default();
}

void add_set_option(Command command, std::vector<std::string>& texts) {
  command
      .add_option("--set", texts,
                  "Value of a further parameter, where the body has one (palpable inspect names "
                  "them)")
      .type_name("NAME=VALUE")
      .further_words(has_equals_sign)
      .default_is("the body's own");
}

}  // namespace palpable::app

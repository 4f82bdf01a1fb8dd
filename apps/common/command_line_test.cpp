#include "apps/common/command_line.h"

#include "palpable/common/base/error.h"
#include "palpable/common/base/json.h"
#include "palpable/common/base/nearest_word.h"
#include "palpable/common/base/text_numbers.h"
#include "tests/support/test.h"

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace palpable::app {
namespace {

// Runs a program with one command that takes a number and may fail.
int run(std::vector<const char*> words) {
  CommandLine app("A program", "prog", "prog 1");
  app.require_subcommand();
  Command halve = app.add_subcommand("halve", "Halve a number");
  int number = 0;
  halve.add_option("--number", number, "Even").required();
  halve.callback([&] {
    if (number % 2 != 0) throw std::runtime_error("odd\nand so no half");
  });
  words.insert(words.begin(), "prog");
  return app.run(static_cast<int>(words.size()), words.data());
}

TEST_CASE("benches are called through palpable or by themselves, and their help says how",
          "[apps][bench]") {
  const auto call = [](std::vector<std::string> words) {
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    const BenchCall bench(static_cast<int>(argv.size()), argv.data());
    std::string rest;
    for (int i = 1; i < bench.argc; ++i) rest += std::string(" ") + bench.argv[i];
    return bench.name + ":" + rest;
  };
  CHECK(call({"palpable", "bench", "live", "--json"}) == "palpable bench: live --json");
  CHECK(call({"palpable", "bench"}) == "palpable bench:");
  CHECK(call({"bin/palpable-bench", "live", "bench"}) == "palpable-bench: live bench");
  CHECK(call({"palpable-bench"}) == "palpable-bench:");
}

TEST_CASE("an argument after an option of several words is not one of them", "[apps]") {
  std::vector<std::string> set, place;
  std::string body;
  const auto read = [&](std::vector<const char*> words) {
    set.clear();
    place.clear();
    body.clear();
    CommandLine app("A program", "prog", "prog 1");
    Command play = app.add_subcommand("play", "Play a body");
    play.add_option("body", body, "A body");
    play.add_option("--set", set, "Values").further_words(has_equals_sign);
    play.add_option("-p,--place", place, "A pose").further_words([](const std::string& word) {
      return to_number(word).has_value();
    });
    play.callback([] {});
    words.insert(words.begin(), {"prog", "play"});
    return app.run(static_cast<int>(words.size()), words.data());
  };
  using Words = std::vector<std::string>;
  CHECK(read({"--set", "E=1", "nu=2", "ball", "--place", "0", "-0.1", "1e-2"}) == 0);
  CHECK(set == Words{"E=1", "nu=2"});
  CHECK(place == Words{"0", "-0.1", "1e-2"});
  CHECK(body == "ball");
  CHECK(read({"-p", "0", "0", "1", "ball"}) == 0);
  CHECK(place == Words{"0", "0", "1"});
  CHECK(body == "ball");
  CHECK(read({"--place", "pose.txt", "ball"}) == 0);
  CHECK(place == Words{"pose.txt"});
  CHECK(read({"ball", "--place=-1", "--place", "2"}) == 0);
  CHECK(place == Words{"-1", "2"});
}

TEST_CASE("every error ends with exit code 1, whatever CLI11 calls it", "[apps][errors]") {
  CHECK(run({"halve", "--number", "4"}) == 0);
  CHECK(run({"--help"}) == 0);
  CHECK(run({"halve", "--help"}) == 0);
  CHECK(run({}) == 1);
  CHECK(run({"half"}) == 1);
  CHECK(run({"halve"}) == 1);
  CHECK(run({"halve", "--numbr", "4"}) == 1);
  CHECK(run({"halve", "--number", "four"}) == 1);
  CHECK(run({"halve", "--number", "3"}) == 1);
  CHECK(run({"--nonsense"}) == 1);
}

// The program's output on stdout for these words.
std::string printed(CommandLine& app, std::vector<const char*> words) {
  words.insert(words.begin(), "prog");
  std::ostringstream text;
  std::streambuf* const usual = std::cout.rdbuf(text.rdbuf());
  const int code = app.run(static_cast<int>(words.size()), words.data());
  std::cout.rdbuf(usual);
  CHECK(code == 0);
  return text.str();
}

// What the program prints on stderr when it refuses these words.
std::string complaint(CommandLine& app, std::vector<const char*> words) {
  words.insert(words.begin(), "prog");
  std::FILE* const usual = stderr;
  char* text = nullptr;
  std::size_t size = 0;
  stderr = ::open_memstream(&text, &size);
  const int code = app.run(static_cast<int>(words.size()), words.data());
  std::fclose(stderr);
  stderr = usual;
  std::string said(text, size);
  std::free(text);
  CHECK(code == 1);
  return said;
}

TEST_CASE("help is at most 100 columns wide and says in words what an option may be",
          "[apps][help]") {
  std::string many_words = "Of";
  for (int i = 0; i < 40; ++i) many_words += " many words";
  CommandLine app("A program", "prog", "prog 1");
  Command command = app.add_subcommand("halve", many_words);
  std::filesystem::path file;
  double share = 1;
  std::string how = "up";
  std::vector<int> some;
  command.add_option("body", file, "Body file").required();
  const Option level = command.add_option("--share", share, many_words).in_range(0.0, 1.0);
  command.add_option("--how", how, "Rounds").one_of({"up", "down"}).show_default();
  command.add_option("--some", some, "Numbers").not_negative().excludes(level).excludes("--how");
  command.add_option("-o,--out", file, "Where to").required();
  command.footer("Example: prog halve " + std::string(60, 'y') + " " + std::string(60, 'z'));

  CHECK(printed(app, {"--help"}).find("Commands:\n  halve") != std::string::npos);
  const std::string help = printed(app, {"halve", "--help"});
  INFO(help);
  std::istringstream lines(help);
  for (std::string line; std::getline(lines, line);) { CHECK(line.size() <= 100); }
  const auto says = [&](const std::string& text) { return help.find(text) != std::string::npos; };
  CHECK(says("Usage: prog halve [OPTIONS] body\n"));
  CHECK(says("\n  body                        Body file\n"));
  CHECK(says("words [0 to 1; default: none; not"));  // wrapped there
  CHECK(says("\n  --how up|down               Rounds [default: up; not with --some]\n"));
  CHECK(says("\n  --some N ...                Numbers [0 or more; default: none; not with"));
  CHECK(says("\n  -o,--out FILE               Where to [required]\n"));
  CHECK(says("yyy \\\n           zzz"));
}

TEST_CASE("lengths have a unit", "[apps][errors]") {
  CommandLine app("A program", "prog", "prog 1");
  Command command = app.add_subcommand("cut", "Cut");
  std::optional<double> edge;
  double width = 0.012;
  command.add_length("--edge", edge, "Edge", {1e-3, 1.0});
  command.add_length("--width", width, "Width");
  command.callback([] {});
  const auto code = [&](std::vector<const char*> words) {
    words.insert(words.begin(), {"prog", "cut"});
    return app.run(static_cast<int>(words.size()), words.data());
  };
  CHECK(code({"--edge", "7mm", "--width", "1.5 cm"}) == 0);
  CHECK(edge == 7 * 1e-3);
  CHECK(width == 1.5 * 1e-2);
  for (const char* text : {"7", "0.007", "7kPa", "0.5mm", "2m", "nan", "nanmm", "-7mm"}) {
    CAPTURE(text);
    CHECK(code({"--edge", text}) == 1);
  }
  CHECK(printed(app, {"cut", "--help"}).find("Width [default: 12mm]") != std::string::npos);
  CHECK(length_text(0.3) == "300mm");
  CHECK(length_text(1.2) == "1.2m");
}

TEST_CASE("a length without unit is refused with the units that fit the option", "[apps][errors]") {
  CommandLine app("A program", "prog", "prog 1");
  Command command = app.add_subcommand("cut", "Cut");
  double side = 0, distance = 0, any = 0;
  command.add_length("--side", side, "Side", {1e-4, 10.0});
  command.add_length("--distance", distance, "Distance", {0.2, 1000.0});
  command.add_length("--any", any, "Any");
  command.callback([] {});
  const auto refused = [&](const char* option, const char* value) {
    return complaint(app, {"cut", option, value});
  };
  using Catch::Contains;
  CHECK_THAT(refused("--side", "25"), Contains("--side: 25 has no unit: write 25mm, see"));
  CHECK_THAT(refused("--distance", "3"), Contains("--distance: 3 has no unit: write 3m, see"));
  CHECK_THAT(refused("--any", "7"), Contains("7 has no unit: write 7mm or 7m, see"));
  CHECK_THAT(refused("--side", "0"), Contains("0 has no unit: write a length such as 0.1mm, see"));
}

TEST_CASE("an argument may also be given as an option, and is explained once", "[apps][help]") {
  std::string source;
  const auto app_of = [&source] {
    auto app = std::make_unique<CommandLine>("A program", "prog", "prog 1");
    Command command = app->add_subcommand("scan", "Scan");
    command.begin_group("Input");
    command.add_option("source,-s,--source", source, "What is seen").type_name("SOURCE").required();
    command.callback([] {});
    return app;
  };
  for (const std::vector<const char*>& words :
       {std::vector<const char*>{"desk"}, {"--source", "desk"}, {"-s", "desk"}}) {
    source.clear();
    std::vector<const char*> all{"prog", "scan"};
    all.insert(all.end(), words.begin(), words.end());
    CHECK(app_of()->run(static_cast<int>(all.size()), all.data()) == 0);
    CHECK(source == "desk");
  }
  CHECK_THAT(complaint(*app_of(), {"scan", "--source", "desk", "other"}),
             Catch::Contains("unexpected argument 'other'"));
  CHECK_THAT(complaint(*app_of(), {"scan", "other", "--source", "desk"}),
             Catch::Contains("--source: ") && Catch::Contains("received 2"));
  CHECK_THAT(complaint(*app_of(), {"scan"}), Catch::Contains("source is missing: prog scan"));
  const std::string help = printed(*app_of(), {"scan", "--help"});
  INFO(help);
  CHECK(help.find("\n  source                      What is seen\n") != std::string::npos);
  CHECK(
      help.find("\n  -s,--source SOURCE          The argument source, as an option [required]\n") !=
      std::string::npos);
  const Json reference = Json::parse(app_of()->reference_json()).value();
  for (const Json& option : reference["commands"][0]["options"]) {
    if (!option["positional"].get<bool>()) continue;
    CHECK(option["names"].size() == 3);
    CHECK(option["names"][0].get<std::string>() == "source");
  }
}

TEST_CASE("options of experts are listed by --help-all, and help COMMAND is COMMAND --help",
          "[apps][help]") {
  CommandLine app("A program", "prog", "prog 1");
  Command command = app.add_subcommand("cut", "Cut");
  int number = 1;
  command.begin_group("Input");
  command.add_option("--number", number, "How many").show_default();
  command.begin_expert_group("Algorithm 1");
  command.add_option("--other", number, "How many others").default_is("as many");
  command.callback([] {});
  const std::string usual = printed(app, {"cut", "--help"});
  CHECK(usual.find("\nInput:\n  --number N ") != std::string::npos);
  CHECK(usual.find("--help-all") != std::string::npos);
  CHECK(usual.find("--other") == std::string::npos);
  CHECK(printed(app, {"help", "cut"}) == usual);
  const Json reference = Json::parse(app.reference_json()).value();
  const std::string all = printed(app, {"cut", "--help-all"});
  CHECK(all.find("\nAlgorithm 1:\n  --other N ") != std::string::npos);
  CHECK(all.find("[default: as many]") != std::string::npos);

  const Json& cut = reference["commands"][0];
  CHECK(cut["name"].get<std::string>() == "cut");
  bool found = false;
  for (const Json& option : cut["options"]) {
    if (option["names"][0].get<std::string>() != "--other") continue;
    found = true;
    CHECK(option["expert"].get<bool>());
    CHECK(option["heading"].get<std::string>() == "Algorithm 1");
    CHECK(option["default"].get<std::string>() == "as many");
  }
  CHECK(found);
}

TEST_CASE("a spelling of 0.1 is refused with the present one", "[apps][errors]") {
  for (const OldSpelling& old : old_spellings()) {
    CAPTURE(old.option, old.command);
    CHECK(old.option.starts_with("-"));
    CHECK_FALSE(old.now.empty());
  }
  CommandLine app("A program", "prog", "prog 1");
  Command command = app.add_subcommand("calibrate", "Calibrate");
  std::string file;
  command.add_option("-o,--out", file, "Where to");
  CHECK(complaint(app, {"calibrate", "--output", "x"}) ==
        "palpable: '--output' was its name in 0.1: write --out, see prog calibrate --help\n");
}

// Runs a program with one option of each numeric type; the values go to `read`.
// Returns the exit code.
int run_numbers(std::vector<const char*> words, std::vector<double>& read) {
  CommandLine app("A program", "prog", "prog 1");
  app.require_subcommand();
  Command command = app.add_subcommand("take", "Take numbers");
  double one = -1;
  std::optional<double> maybe;
  std::vector<double> many;
  std::vector<std::string> settings;
  command.add_option("--one", one, "One").in_range(0.0, 1.0);
  command.add_option("--any", one, "One");
  command.add_option("--maybe", maybe, "One or none").positive();
  command.add_option("--many", many, "Several").not_negative();
  add_set_option(command, settings);
  command.callback([&] {
    read = {one, maybe.value_or(-1)};
    read.insert(read.end(), many.begin(), many.end());
    for (const auto& [name, value] : parse_settings(settings)) read.push_back(value);
  });
  words.insert(words.begin(), {"prog", "take"});
  return app.run(static_cast<int>(words.size()), words.data());
}

TEST_CASE("numbers of options are finite, whatever their range", "[apps][errors]") {
  std::vector<double> read;
  CHECK(run_numbers({"--one", "0.5", "--maybe", "+2", "--many", "1e3", "4", "--set", "a=-7"},
                    read) == 0);
  CHECK(read == std::vector<double>{0.5, 2, 1e3, 4, -7});
  for (const char* option : {"--one", "--any", "--maybe", "--many"}) {
    for (const char* value : {"nan", "NaN", "-nan", "inf", "-inf", "infinity", "1e999", "one"}) {
      INFO(option << " " << value);
      CHECK(run_numbers({option, value}, read) == 1);
    }
  }
  for (const char* value : {"a=nan", "a=inf", "a=1e999", "a=", "=1", "a"}) {
    INFO(value);
    CHECK(run_numbers({"--set", value}, read) == 1);
  }
  CHECK(run_numbers({"--many", "1", "nan"}, read) == 1);
}

TEST_CASE("two sides are whole numbers that fit", "[apps]") {
  CHECK(parse_extent("1280x720") == std::array{1280, 720});
  for (const char* text : {"", "x", "1x", "x1", "1x0", "-1x1", "1.5x2", "1x2x3", "1x2 ", "nanx1",
                           "4294968576x720", "99999999999999999999x1"}) {
    INFO(text);
    CHECK_FALSE(parse_extent(text));
  }
}

TEST_CASE("the nearest word is suggested when it is near enough to have been meant", "[apps]") {
  const std::vector<std::string> words{"live", "view", "inspect"};
  CHECK(nearest_word("liev", words) == "live");
  CHECK(nearest_word("inspekt", words) == "inspect");
  CHECK(nearest_word("veiw", words) == "view");
  CHECK(nearest_word("bake", words).empty());
  CHECK(nearest_word("", words).empty());
}

TEST_CASE("an option of one word leaves the next word to the command", "[apps]") {
  CommandLine app("A program", "prog", "prog 1");
  Command command = app.add_subcommand("go", "Go");
  std::string body, out;
  command.add_option("body", body, "Body");
  command
      .add_option(
          "--out",
          [&](const std::vector<std::string>& words) {
            out = words.front();
            return std::string();
          },
          "Out")
      .words(1, 1);
  command.callback([] {});
  const std::array words{"prog", "go", "--out", "there", "bunny"};
  CHECK(app.run(static_cast<int>(words.size()), words.data()) == 0);
  CHECK(out == "there");
  CHECK(body == "bunny");
}

TEST_CASE("options from a file count as given, unless the command line has them", "[apps]") {
  using Options = std::vector<Command::FileOption>;
  struct Read {
    int number = 1;
    std::vector<std::string> names;
    bool loud = false;
    std::string place, anchor;
    std::string given, trouble;
  };
  const auto read = [](std::vector<const char*> words, const Options& file) {
    Read values;
    CommandLine app("A program", "prog", "prog 1");
    Command command = app.add_subcommand("go", "Go");
    command.add_option("--number", values.number, "N").in_range(0, 9);
    command.add_option("--names", values.names, "Names");
    command.add_flag("--loud", values.loud, "Loud");
    command.add_option("--place", values.place, "Place");
    command.add_option("--anchor", values.anchor, "Anchor").excludes("--place");
    command.callback([&] {
      try {
        command.set_from_file(file);
      } catch (const Error& error) { values.trouble = error.what(); }
      for (const Command::GivenOption& one : command.given_options()) {
        values.given += one.name + (one.is_flag ? "! " : " ");
      }
    });
    words.insert(words.begin(), {"prog", "go"});
    CHECK(app.run(static_cast<int>(words.size()), words.data()) == 0);
    return values;
  };
  const Options all{
      {"number", {"3"}, "f:1"}, {"names", {"a", "b"}, "f:2"}, {"loud", {"true"}, "f:3"}};
  const Read from_file = read({}, all);
  CHECK(from_file.trouble.empty());
  CHECK(from_file.number == 3);
  CHECK(from_file.names == std::vector<std::string>{"a", "b"});
  CHECK(from_file.loud);
  CHECK(from_file.given == "number names loud! ");

  const Read overridden = read({"--number", "5", "--names", "c"}, all);
  CHECK(overridden.number == 5);
  CHECK(overridden.names == std::vector<std::string>{"c"});
  // An option that the command line excludes is left out; two of the file that exclude each other
  // are an error.
  CHECK(read({"--place", "here"}, {{"anchor", {"plane"}, "f:1"}}).anchor.empty());
  CHECK_THAT(read({}, {{"place", {"x"}, "f:1"}, {"anchor", {"y"}, "f:2"}}).trouble,
             Catch::Contains("f:2") && Catch::Contains("exclude"));
  CHECK_THAT(read({}, {{"numbr", {"3"}, "f:7"}}).trouble,
             Catch::StartsWith("f:7: ") && Catch::Contains("did you mean 'number'?"));
  CHECK_THAT(read({}, {{"number", {"10"}, "f:8"}}).trouble, Catch::StartsWith("f:8: "));
  CHECK_THAT(read({}, {{"number", {"3", "4"}, "f:8"}}).trouble, Catch::StartsWith("f:8: "));
  CHECK_THAT(read({}, {{"loud", {"loudly"}, "f:9"}}).trouble, Catch::Contains("true or false"));
  CHECK_FALSE(read({}, {{"loud", {"false"}, "f:9"}}).loud);
}

}  // namespace
}  // namespace palpable::app

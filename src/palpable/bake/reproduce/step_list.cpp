#include "palpable/bake/reproduce/step_list.h"

#include "palpable/common/base/bounded_text.h"
#include "palpable/common/base/error.h"
#include "palpable/common/base/json.h"
#include "palpable/common/base/output_file.h"
#include "palpable/common/base/progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>

namespace palpable {
namespace {

namespace fs = std::filesystem;

std::string key_of(const Step& step) {
  std::string key = step.program.string();
  for (const std::string& word : step.words) key += '\n' + word;
  return key;
}

// Runs a program with its standard output in `log`. @returns the status of waitpid()
int run_program(const Step& step, const fs::path& log) {
  std::vector<std::string> words{step.program.string()};
  words.insert(words.end(), step.words.begin(), step.words.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log.c_str(),
                                     O_WRONLY | O_CREAT | O_TRUNC, 0644);
  pid_t pid = -1;
  const int error =
      ::posix_spawn(&pid, step.program.c_str(), &actions, nullptr, argv.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (error != 0) {
    throw Error(fmt::format("cannot start {}: {}", step.program.string(), std::strerror(error)));
  }
  int status = 0;
  while (::waitpid(pid, &status, 0) < 0 && errno == EINTR) {}
  return status;
}

}  // namespace

std::string Step::command(const fs::path& base) const {
  std::string text = program.filename().string();
  for (const std::string& word : words) {
    const fs::path path(word);
    const std::string shown = path.is_absolute() ? path.lexically_proximate(base).string() : word;
    const bool quoted = shown.find(' ') != std::string::npos;
    text += quoted ? fmt::format(" \"{}\"", shown) : " " + shown;
  }
  return text;
}

StepList::StepList(fs::path folder) : folder_(std::move(folder)) {
  make_folder(folder_ / "logs");
  const fs::path file = folder_ / "steps.json";
  if (!fs::exists(file)) return;
  const Json all =
      value_or_throw(Json::parse(value_or_throw(read_bounded_text(file, Notation::kJson))));
  for (const Json& one : all) {
    done_.push_back({one["command"].get<std::string>(), one["seconds"].get<double>()});
  }
}

const StepList::Done* StepList::find(const Step& step) const {
  const std::string key = key_of(step);
  const auto found =
      std::find_if(done_.begin(), done_.end(), [&](const Done& d) { return d.key == key; });
  return found == done_.end() ? nullptr : &*found;
}

bool StepList::is_done(const Step& step) const {
  return find(step) != nullptr && fs::exists(step.product);
}

double StepList::seconds(const Step& step) const {
  const Done* done = find(step);
  return done == nullptr ? 0 : done->seconds;
}

StepTimes StepList::times(const std::vector<Step>& steps) const {
  StepTimes times;
  for (const Step& step : steps) (step.is_bake ? times.bakes : times.others) += seconds(step);
  return times;
}

void StepList::keep() const {
  Json all = Json::array();
  for (const Done& done : done_) {
    all.push_back({{"command", done.key}, {"seconds", done.seconds}});
  }
  write_whole_file(folder_ / "steps.json", all.dump(1) + "\n");
}

void StepList::run_one(const Step& step, std::size_t number) {
  if (!step.own_folder.empty()) fs::remove_all(step.own_folder);
  make_folder(step.own_folder.empty() ? step.product.parent_path() : step.own_folder.parent_path());
  const fs::path log = folder_ / "logs" / fmt::format("{:02}.txt", number);
  if (step.prints_product) fs::remove(step.product);  // left by an earlier version of the step
  const auto begin = std::chrono::steady_clock::now();
  const int status = run_program(step, log);
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  if (WIFSIGNALED(status) && (WTERMSIG(status) == SIGINT || WTERMSIG(status) == SIGTERM)) {
    throw Error("stopped; the same command goes on where it was");
  }
  if (status == 0 && step.prints_product) fs::rename(log, step.product);
  if (status != 0 || !fs::exists(step.product)) {
    throw Error(
        fmt::format("{}: failed; what it printed is in {}, its command was\n  {}\nonce that is "
                    "mended, the same "
                    "command goes on from here",
                    step.what, log.string(), step.command({})));
  }
  std::erase_if(done_, [&](const Done& d) { return d.key == key_of(step); });
  done_.push_back({key_of(step), taken.count()});
  keep();
}

void StepList::run(const std::vector<Step>& steps,
                   const std::function<void(const std::string&)>& say) {
  double expected_done = 0, took = 0;  // s, of the steps that ran in this call
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const Step& step = steps[i];
    if (is_done(step)) continue;
    double left = 0;
    for (std::size_t k = i; k < steps.size(); ++k) left += is_done(steps[k]) ? 0 : steps[k].seconds;
    // Ratio of this machine's time to the expected one; 1 until 30 s of expected work are done.
    const double slower = expected_done > 30 ? took / expected_done : 1.0;
    say(fmt::format("[{} of {}] {}; some {} left", i + 1, steps.size(), step.what,
                    duration_text(left * slower)));
    run_one(step, i + 1);
    expected_done += step.seconds;
    took += seconds(step);
  }
}

}  // namespace palpable

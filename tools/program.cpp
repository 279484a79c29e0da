#include "program.h"

#include <console_bridge/console.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "ros/resources.h"

namespace tccm {
namespace {

volatile std::sig_atomic_t interrupted = 0;

/// In quotes for a shell.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

}  // namespace

int runProgram(CLI::App& app, const std::vector<std::string>& arguments,
               const std::function<int()>& work) {
  // Libraries that log on their own would blur the one line that says what is wrong.
  console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_NONE);
  try {
    // CLI11 takes the last first, without the program's name.
    app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend() - 1));
    return work();
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", app.get_name().c_str(), error.what());
    return kBadInput;
  }
}

std::string formatted(const char* format, ...) {
  std::va_list values;
  va_start(values, format);
  std::va_list again;
  va_copy(again, values);
  std::string text(static_cast<std::size_t>(std::vsnprintf(nullptr, 0, format, values)), '\0');
  std::vsnprintf(text.data(), text.size() + 1, format, again);
  va_end(again);
  va_end(values);
  return text;
}

std::string readText(const std::string& path, const std::string& what) {
  std::ifstream file(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (!file) throw InputError("cannot read " + what + ": " + path);
  if (text.empty()) throw InputError(what + " is empty: " + path);
  return text;
}

void writeText(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) throw InputError("cannot write " + path);
}

void makeFolder(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (!std::filesystem::is_directory(path)) throw InputError("cannot make the folder " + path);
}

int runScript(const std::string& script, const std::vector<std::string>& arguments) {
  const auto folder = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  std::string command = quoted((folder / script).string());
  for (const std::string& argument : arguments) command += " " + quoted(argument);
  std::fflush(stdout);
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

void deferInterrupt() {
  struct sigaction action = {};
  action.sa_handler = [](int /*signal*/) { interrupted = 1; };
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
}

bool isInterrupted() { return interrupted != 0; }

void tellWarnings(const RobotModel& model, const std::string& program) {
  for (const std::string& warning : model.warnings()) {
    std::fprintf(stderr, "%s: warning: %s\n", program.c_str(), warning.c_str());
  }
}

Progress progressBar() {
  if (isatty(STDERR_FILENO) == 0) return {};
  return [shown = -1](double fraction) mutable {
    const int percent = static_cast<int>(100.0 * fraction);
    if (percent == shown) return;
    shown = percent;
    const std::string bar(static_cast<std::size_t>(percent / 2), '#');
    std::fprintf(stderr, "\r[%-50s] %3d %%%s", bar.c_str(), percent, percent == 100 ? "\n" : "");
  };
}

RobotResources resourcesIn(const std::string& package_path) {
  if (!package_path.empty() && !std::filesystem::is_directory(package_path)) {
    throw InputError("--package-path: no such folder: " + package_path);
  }
  RobotResources resources;
  resources.read = resourceReader(package_path);
  resources.fit_cache_folder = fitCacheFolder();
  return resources;
}

ScratchFile::ScratchFile(const std::string& ending)
    : path_((std::filesystem::temp_directory_path() /
             formatted("tccm_monitor_%d.%s", static_cast<int>(getpid()), ending.c_str()))
                .string()) {}

ScratchFile::~ScratchFile() {
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

}  // namespace tccm

#pragma once

#include <CLI/App.hpp>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "tccm_monitor/robot_model.h"

namespace tccm {

/// Exit statuses of all programs.
constexpr int kDone = 0;
constexpr int kLimitMissed = 1;
constexpr int kBadInput = 2;
constexpr int kInterrupted = 130;  ///< by Ctrl-C

/// Parses a program's arguments and does its work. What help prints goes to standard output; of
/// what is wrong standard error gets one line that begins with the program's name.
/// @param arguments main()'s. @param work called once they are parsed. @return the exit status.
[[nodiscard]] int runProgram(CLI::App& app, const std::vector<std::string>& arguments,
                             const std::function<int()>& work);
/// The same of a program whose options are all that it is told.
/// @param declare adds them. @param run is handed what they were on the command line.
template <typename Options>
[[nodiscard]] int runProgram(const std::string& name, const std::string& description,
                             const std::vector<std::string>& arguments,
                             void (*declare)(CLI::App&, Options&), int (*run)(Options&),
                             Options options = {}) {
  CLI::App app(description, name);
  declare(app, options);
  return runProgram(app, arguments, [&] { return run(options); });
}

/// Input that a program cannot work with. what() says it in one line.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Where a file may lie that is gone with this object.
class ScratchFile {
 public:
  /// @param ending of its name; one of each in a process.
  explicit ScratchFile(const std::string& ending);
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  ~ScratchFile();
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// As printf would print it.
[[nodiscard, gnu::format(printf, 1, 2)]] std::string formatted(const char* format, ...);

/// @throws InputError where the file cannot be read or is empty. @param what names it in messages.
[[nodiscard]] std::string readText(const std::string& path, const std::string& what);
/// @throws InputError where not all of it could be written.
void writeText(const std::string& path, const std::string& text);

/// Where it is not there yet. @throws InputError
void makeFolder(const std::string& path);

/// Runs one of the scripts that are installed beside the program. What it prints is printed.
/// @return its exit status; 128 and its number where a signal ended it.
[[nodiscard]] int runScript(const std::string& script, const std::vector<std::string>& arguments);

/// From now on the first Ctrl-C ends nothing by itself; the second does.
void deferInterrupt();
/// Whether that Ctrl-C came.
[[nodiscard]] bool isInterrupted();

/// What of a robot is taken otherwise than it stands, a line each on standard error.
void tellWarnings(const RobotModel& model, const std::string& program);

/// @param fraction_done from 0 to 1.
using Progress = std::function<void(double fraction_done)>;
/// A bar on standard error; empty where that is no terminal.
[[nodiscard]] Progress progressBar();

/// Resources as the nodelets find them, and in a folder of packages.
/// @param package_path may be empty. @throws InputError where there is no such folder.
[[nodiscard]] RobotResources resourcesIn(const std::string& package_path);

}  // namespace tccm

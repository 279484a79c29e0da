#include "experiments/experiment.h"

#include <link.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "experiments/simulated_settings.h"
#include "simulation/robot/dual_arm.h"

namespace tccm::simulation {
namespace {

MonitorConfig trialSettings(const std::string& config, const SensorChoice& sensors) {
  MonitorConfig settings = simulatedSettings(config);
  sensors.applyTo(settings);
  settings.checker.checker.clearance_radius_m = 0.0;
  return settings;
}

/// Which of the cases one of several programs runs: each Nth.
struct Part {
  std::size_t number = 0, of = 1;
};

/// @throws InputError
Part partOf(const std::string& text) {
  Part part;
  int length = 0;
  const int read = std::sscanf(text.c_str(), "%zu/%zu%n", &part.number, &part.of, &length);
  if (read == 2 && static_cast<std::size_t>(length) == text.size() && part.number < part.of) {
    return part;
  }
  throw InputError("--part: has to be K/N, with K from 0 to N - 1: " + text);
}

std::string partPath(const std::string& folder, std::size_t number) {
  return (std::filesystem::path(folder) / ("part_" + std::to_string(number))).string();
}

/// Of the files that this program is made of: its own, and the package's libraries.
std::uint64_t buildHash() {
  std::uint64_t hash = 14695981039346656037U;  // FNV-1a
  const auto addFile = [](dl_phdr_info* info, std::size_t /*size*/, void* data) {
    const std::string name = info->dlpi_name;
    if (!name.empty() && name.find("tccm_monitor") == std::string::npos) return 0;
    auto& sum = *static_cast<std::uint64_t*>(data);
    std::ifstream file(name.empty() ? "/proc/self/exe" : name, std::ios::binary);
    for (std::istreambuf_iterator<char> byte(file), end; byte != end; ++byte) {
      sum = (sum ^ static_cast<unsigned char>(*byte)) * 1099511628211U;
    }
    return 0;
  };
  dl_iterate_phdr(addFile, &hash);
  return hash;
}

/// Says of which run a part is. @return which part. @throws InputError where it is of another run,
/// or of another build, whose bytes mean something else.
Part archiveHead(Archive& archive, const TrialOptions& options, std::size_t count, Part part) {
  static const std::uint64_t kBuild = buildHash();
  std::uint64_t build = kBuild;
  archive(build);
  if (build != kBuild) {
    throw InputError("--join: a part is of another build of the package: " + options.join);
  }
  auto experiment = options.experiment;
  auto seed = options.seed;
  auto cases = count;
  archive(experiment, seed, cases, part.number, part.of);
  if (experiment == options.experiment && seed == options.seed && cases == count) return part;
  throw InputError("--join: the parts are of another run: " + options.join);
}

/// @throws InputError
void join(const TrialOptions& options, std::size_t count,
          const std::function<void(std::size_t, Archive&)>& archived) {
  std::size_t parts = 1;
  for (std::size_t k = 0; k < parts; ++k) {
    Archive archive(readText(partPath(options.join, k), "a part of the trials"));
    const Part part = archiveHead(archive, options, count, {});
    if (k == 0) parts = part.of;
    if (part.number != k || part.of != parts) {
      throw InputError("--join: the parts are of several runs: " + options.join);
    }
    for (std::size_t i = k; i < count; i += parts) archived(i, archive);
    if (!archive.atEnd()) throw InputError("--join: a part has more than its cases");
  }
}

}  // namespace

TrialRun::TrialRun(const TrialOptions& options, Progress progress)
    : options(options),
      progress(std::move(progress)),
      settings(trialSettings(options.config, options.sensors.choice())),
      sensors(options.sensors.choice()),
      model(std::make_shared<const RobotModel>(dualArmUrdf(), settings.robot)) {}

void TrialRun::requireLaserAlone() const {
  if (sensors.isLaserAlone()) return;
  throw InputError("--sensors: this experiment knows the laser alone");
}

std::uint64_t TrialRun::seedOf(std::size_t trial) const { return 1000003 * options.seed + trial; }

void TrialRun::requireWhole() const {
  if (options.part.empty() && options.join.empty()) return;
  throw InputError("--scheduler: the cases of this experiment cannot be run apart");
}

void TrialRun::forEach(std::size_t count, const std::function<void(std::size_t)>& work,
                       const std::function<void(std::size_t, Archive&)>& archived) const {
  if (!options.join.empty()) return join(options, count, archived);
  if (options.part.empty()) return inParallel(count, options.jobs, work, progress);
  const Part part = partOf(options.part);
  const std::size_t own = count > part.number ? (count - part.number - 1) / part.of + 1 : 0;
  inParallel(
      own, options.jobs, [&](std::size_t k) { work(part.number + k * part.of); }, progress);
  Archive archive;
  archiveHead(archive, options, count, part);
  for (std::size_t k = 0; k < own; ++k) archived(part.number + k * part.of, archive);
  writeText(partPath(options.out, part.number), archive.bytes());
  throw PartDone();
}

}  // namespace tccm::simulation

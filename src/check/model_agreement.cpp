#include "check/model_agreement.h"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <map>

#include "base/line_of.h"

namespace tccm {
namespace {

constexpr Duration kPeriod = std::chrono::milliseconds(100);  // at most one comparison in it
// Stamps of transforms and of joint states may differ by this: many publishers date a transform by
// the clock, not by the joint state that it follows from.
constexpr Duration kLag = std::chrono::milliseconds(100);
constexpr int kLagSteps = 8;                                 // looked at to either side
constexpr Duration kAheadMax = std::chrono::seconds(1);      // that transforms may be dated by
constexpr Duration kPatience = std::chrono::seconds(2);      // with joint states and transforms
constexpr std::size_t kAwaited = 20;                         // instants that joints have to reach
constexpr Duration kThinned = std::chrono::milliseconds(5);  // between two joint states kept
constexpr Duration kJumpBack = std::chrono::seconds(1);      // more is time beginning anew
constexpr std::size_t kSamples = 512;                        // kept of each joint
constexpr double kGapMax = 0.25;                             // [s] that joints are interpolated
constexpr std::uint32_t kHistory = (1U << 10U) - 1U;         // the last ten comparisons
constexpr std::size_t kDisagree = 5;                         // of them are no chance
constexpr std::size_t kAgree = 1;                            // are
constexpr std::size_t kSensors = 16;                         // told apart
constexpr double kSensorLever = 1.0;  // [m] at which a sensor's rotation counts
constexpr double kFarOff = 3.0;       // [m]

std::size_t countOf(std::uint32_t history) { return std::bitset<32>(history).count(); }

/// A sensor's origin, and what it sees at an arm's reach.
std::vector<Vector3> sensorPoints() {
  std::vector<Vector3> points{Vector3::Zero()};
  for (int axis = 0; axis < 3; ++axis) {
    points.push_back(kSensorLever * Vector3::Unit(axis));
    points.push_back(-kSensorLever * Vector3::Unit(axis));
  }
  return points;
}

/// Without zeros that have a sign.
Vector3 roundedToMillimetres(const Vector3& metres) {
  return 1e-3 * (1e3 * metres).array().round().matrix() + Vector3::Zero();
}

std::string namesOf(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace

void ModelAgreement::Config::describe(ParameterTable& table) {
  table.add("model_tolerance_m", &tolerance_m, "m", {0.001, 1000.0},
            "further off at a link's far end, tf and the URDF with joint states disagree about "
            "where it is; of a sensor a metre from it");
}

ModelAgreement::ModelAgreement(std::shared_ptr<const RobotModel> model, const Config& config)
    : model_(std::move(model)), config_(validated(config)) {
  const JointTree& tree = model_->frames();
  for (std::size_t v = 0; v < tree.variables.size(); ++v) {
    variables_[tree.variables[v].name] = v;
    tracks_.emplace_back(kSamples, tree.turnsFreely(v));
  }
  positions_.resize(tree.variables.size());
  for (const std::string& link : tree.links) {
    const auto& links = model_->links();
    const auto found = std::find(links.begin(), links.end(), link);
    if (found == links.end()) continue;
    const auto index = static_cast<std::size_t>(found - links.begin());
    if (auto points = farPointsOf(*model_, index); !points.empty()) {
      addFrame(link, std::move(points), false);
    }
  }
}

void ModelAgreement::reconfigure(const Config& config) { config_ = validated(config); }

void ModelAgreement::addFrame(const std::string& link, std::vector<Vector3> points,
                              bool is_sensor) {
  const JointTree& tree = model_->frames();
  const auto found = std::find(tree.links.begin(), tree.links.end(), link);
  if (found == tree.links.end()) return;
  FrameChain chain(tree, static_cast<std::size_t>(found - tree.links.begin()));
  if (chain.empty()) return;
  const std::string& reference = tree.links[chain.root()];
  Compared result;
  result.link = link;
  result.reference = reference;
  result.is_sensor = is_sensor;
  frames_.push_back({std::move(result),
                     model_->frameOf(reference),
                     model_->frameOf(link),
                     std::move(chain),
                     std::move(points),
                     {},
                     {},
                     {},
                     0,
                     {}});
  frames_.back().awaited.reserve(kAwaited + 1);
}

void ModelAgreement::addJoints(Time stamp, const std::vector<std::string>& names,
                               const std::vector<double>& positions) {
  for (std::size_t i = 0; i < names.size() && i < positions.size(); ++i) {
    const auto found = variables_.find(names[i]);
    if (found == variables_.end() || !(std::abs(positions[i]) < 1e6)) continue;
    JointTrack& track = tracks_[found->second];
    if (track.size() > 0 && track.newest(0).stamp - stamp > kJumpBack) track.clear();
    if (track.size() > 0 && stamp - track.newest(0).stamp < kThinned) continue;
    track.add({stamp, positions[i], 0.0, 0});
  }
}

void ModelAgreement::watchSensor(const std::string& frame) {
  if (std::find(sensors_.begin(), sensors_.end(), frame) != sensors_.end()) return;
  if (sensors_.size() == kSensors) return;
  sensors_.push_back(frame);
  for (const std::string& link : model_->frames().links) {
    if (model_->frameOf(link) == frame) return addFrame(link, sensorPoints(), true);
  }
  unknown_sensors_.push_back(frame);
}

void ModelAgreement::reset() {
  for (JointTrack& track : tracks_) track.clear();
  for (Frame& frame : frames_) {
    frame.awaited.clear();
    frame.stamp.reset();
    frame.when.reset();
    frame.history = 0;
    frame.result.disagrees = false;
  }
  first_.reset();
  last_.reset();
  cause_ = {};
}

bool ModelAgreement::compare(Time now, const Transforms& transforms) {
  if (last_ && now - *last_ < kPeriod) return false;
  if (!first_) first_ = now;
  last_ = now;
  for (Frame& frame : frames_) compareFrame(frame, now, transforms);
  renewCause();
  return true;
}

void ModelAgreement::compareFrame(Frame& frame, Time now, const Transforms& transforms) {
  if (frame.when && now - *frame.when > kPatience) {  // not both are known any more
    frame.history = 0;
    frame.result.disagrees = false;
  }
  const auto newest = transforms.newest(frame.tf_reference, frame.tf_frame);
  if (!newest) {
    frame.result.state = Compared::State::kNoTransform;
    return;
  }
  const auto stamp = instantOf(frame, *newest);
  if (!stamp) return;
  const auto by_tf = *stamp == newest->stamp
                         ? newest->pose
                         : transforms.at(frame.tf_reference, frame.tf_frame, *stamp);
  if (!by_tf || !isRigid(*by_tf)) return;
  if (!findPositions(frame, *stamp)) {
    frame.result.state = Compared::State::kNoJoints;
    return;
  }
  const Displacement displacement = displacementOf(frame, *by_tf);
  const bool is_beyond =
      displacement.distance_m > config_.tolerance_m && !isExplainedByStamps(frame, *stamp, *by_tf);
  note(frame, now, *stamp, displacement, is_beyond);
}

std::optional<Time> ModelAgreement::instantOf(Frame& frame,
                                              const Transforms::Newest& newest) const {
  std::optional<Time> joints;  // up to which all of them are known
  for (const std::size_t variable : frame.chain.variables()) {
    if (tracks_[variable].size() == 0) {
      frame.result.state = Compared::State::kNoJoints;
      return std::nullopt;
    }
    const Time stamp = tracks_[variable].newest(0).stamp;
    joints = joints ? std::min(*joints, stamp) : stamp;
  }
  if (!joints) {  // nothing moves it: what is said once and again is one sample
    const bool is_new = newest.is_static || frame.stamp != newest.stamp;
    return is_new ? std::optional<Time>(newest.stamp) : std::nullopt;
  }
  const Time answered = *joints - kLag;
  if (newest.is_static || newest.stamp - answered > kAheadMax) {
    return frame.stamp != answered ? std::optional<Time>(answered) : std::nullopt;
  }
  std::vector<Time>& awaited = frame.awaited;
  const Time last = awaited.empty() ? frame.stamp.value_or(Time()) : awaited.back();
  if (newest.stamp != last) awaited.push_back(newest.stamp);
  if (awaited.size() > kAwaited) awaited.erase(awaited.begin());
  const auto isAnswered = [answered](Time stamp) { return stamp <= answered; };
  const auto left = std::find_if_not(awaited.begin(), awaited.end(), isAnswered);
  if (left == awaited.begin()) return std::nullopt;
  const Time found = *(left - 1);
  awaited.erase(awaited.begin(), left);
  return found;
}

bool ModelAgreement::findPositions(const Frame& frame, Time stamp) {
  for (const std::size_t variable : frame.chain.variables()) {
    const auto position = tracks_[variable].at(stamp, kGapMax);
    if (!position) return false;
    positions_[variable] = *position;
  }
  return true;
}

Displacement ModelAgreement::displacementOf(const Frame& frame, const Pose& by_tf) const {
  return worstDisplacement(frame.chain.at(positions_), by_tf, frame.points);
}

bool ModelAgreement::isExplainedByStamps(const Frame& frame, Time stamp, const Pose& by_tf) {
  for (int step = -kLagSteps; step <= kLagSteps; ++step) {
    if (!findPositions(frame, stamp + step * kLag / kLagSteps)) continue;
    if (displacementOf(frame, by_tf).distance_m <= config_.tolerance_m) return true;
  }
  return false;
}

void ModelAgreement::note(Frame& frame, Time now, Time stamp, const Displacement& displacement,
                          bool is_beyond) {
  frame.stamp = stamp;
  frame.when = now;
  frame.last = displacement;
  frame.history = ((frame.history << 1U) | (is_beyond ? 1U : 0U)) & kHistory;
  Compared& result = frame.result;
  result.state = Compared::State::kCompared;
  ++result.comparisons;
  result.beyond += is_beyond ? 1 : 0;
  result.worst_m = std::max(result.worst_m, displacement.distance_m);
  const std::size_t beyond = countOf(frame.history);
  if (beyond >= kDisagree) result.disagrees = result.did_disagree = true;
  if (beyond <= kAgree) result.disagrees = false;
}

void ModelAgreement::renewCause() {
  const Frame* first = nullptr;
  std::size_t others = 0;
  for (const Frame& frame : frames_) {
    if (!frame.result.disagrees) continue;
    if (first) ++others;
    if (!first) first = &frame;
  }
  if (!first) {
    cause_ = {};
    return;
  }
  const Vector3 offset = roundedToMillimetres(first->last.offset);
  const char* question =
      first->last.distance_m > kFarOff ? " (is one of them in millimetres?)" : "";
  std::string text = lineOf(
      "tf puts '%.80s' %.3f m off where the URDF and joint states do%s, by (%.3f, %.3f, %.3f) in "
      "'%.80s', model_tolerance_m is %.3g",
      first->result.link.c_str(), first->last.distance_m, question, offset.x(), offset.y(),
      offset.z(), first->result.reference.c_str(), config_.tolerance_m);
  if (others > 0) text += ", and " + std::to_string(others) + " more";
  text += ": correct the one that is wrong; a link that tf places rightly goes to trusted_frames";
  if (first_disagreement_.empty()) first_disagreement_ = text;
  cause_ = Cause(Reason::kModelDisagrees, std::move(text), first->result.link);
}

std::vector<ModelAgreement::Compared> ModelAgreement::compared() const {
  std::vector<Compared> results;
  for (const Frame& frame : frames_) results.push_back(frame.result);
  return results;
}

std::vector<std::string> ModelAgreement::notCompared() const {
  std::vector<std::string> texts;
  for (const std::string& sensor : unknown_sensors_) {
    texts.push_back(sensor + ": the URDF does not know it");
  }
  if (!first_ || *last_ - *first_ < kPatience) return texts;
  std::map<std::string, std::vector<std::string>> links;  // by why they are not compared
  for (const Frame& frame : frames_) {
    if (frame.result.comparisons == 0) links[whyNot(frame)].push_back(frame.result.link);
  }
  for (const auto& [why, named] : links) texts.push_back(namesOf(named) + ": " + why);
  return texts;
}

std::string ModelAgreement::whyNot(const Frame& frame) const {
  if (frame.result.state == Compared::State::kNoTransform) {
    return "tf does not have it in '" + frame.tf_reference + "'";
  }
  for (const std::size_t variable : frame.chain.variables()) {
    if (tracks_[variable].size() > 0) continue;
    return "no joint state has '" + model_->frames().variables[variable].name + "'";
  }
  return "no transform and joint states of one time";
}

}  // namespace tccm

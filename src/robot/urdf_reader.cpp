#include "robot/urdf_reader.h"

#include <console_bridge/console.h>
#include <tinyxml2.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <mutex>
#include <set>

#include "geometry/pose.h"
#include "robot/xml_limits.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

constexpr std::size_t kMessageMax = 300;
constexpr double kFurthest = 1e6;  // [m]; beyond it is a slip, and sums would end at infinity

/// One line, of what can be printed, not too long.
std::string asOneLine(const std::string& text) {
  std::string line;
  for (const char c : text.substr(0, kMessageMax)) {
    line += std::isprint(static_cast<unsigned char>(c)) != 0 ? c : ' ';
  }
  return line;
}

/// Catches what urdfdom logs while it parses: only there it says which element is wrong.
class ErrorCatcher : public console_bridge::OutputHandler {
 public:
  ErrorCatcher() : lock_(mutex()), previous_(console_bridge::getOutputHandler()) {
    console_bridge::useOutputHandler(this);
  }
  ~ErrorCatcher() override {
    if (previous_) {
      console_bridge::useOutputHandler(previous_);
    } else {
      console_bridge::noOutputHandler();
    }
  }
  ErrorCatcher(const ErrorCatcher&) = delete;
  ErrorCatcher& operator=(const ErrorCatcher&) = delete;

  void log(const std::string& text, console_bridge::LogLevel level, const char* /*file*/,
           int /*line*/) override {
    if (level < console_bridge::CONSOLE_BRIDGE_LOG_ERROR || count_++ >= kKept) return;
    errors_ += (errors_.empty() ? "" : "; ") + text;
  }
  [[nodiscard]] std::string errors() const { return asOneLine(errors_); }

 private:
  static constexpr std::size_t kKept = 3;
  static std::mutex& mutex() {
    static std::mutex instance;
    return instance;
  }

  std::lock_guard<std::mutex> lock_;
  console_bridge::OutputHandler* previous_;
  std::size_t count_ = 0;
  std::string errors_;
};

/// Where each link has a parent, urdfdom finds no root, and names none of them.
void requireNoCircle(const std::string& text) {
  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) return;
  const auto linkIn = [](const tinyxml2::XMLElement* end) {
    const char* link = end == nullptr ? nullptr : end->Attribute("link");
    return std::string(link == nullptr ? "" : link);
  };
  std::map<std::string, std::string> parents;
  const tinyxml2::XMLElement* robot = document.FirstChildElement("robot");
  const tinyxml2::XMLElement* joint =
      robot == nullptr ? nullptr : robot->FirstChildElement("joint");
  for (; joint != nullptr; joint = joint->NextSiblingElement("joint")) {
    parents[linkIn(joint->FirstChildElement("child"))] = linkIn(joint->FirstChildElement("parent"));
  }
  parents.erase("");
  if (parents.empty()) return;
  // Upwards as often as there are joints: what is not at an end then is on a circle.
  std::string link = parents.begin()->first;
  for (std::size_t i = 0; i < parents.size(); ++i) {
    const auto above = parents.find(link);
    if (above == parents.end()) return;
    link = above->second;
  }
  if (parents.count(link) > 0) {
    throw ConfigError("robot_description: link '" + link +
                      "' is below itself: its joints form a circle");
  }
}

urdf::ModelInterfaceSharedPtr parse(const std::string& text) {
  urdf::ModelInterfaceSharedPtr urdf;
  std::string why;
  const console_bridge::LogLevel level = console_bridge::getLogLevel();
  {
    ErrorCatcher catcher;
    console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_ERROR);
    try {
      urdf = urdf::parseURDF(text);
      why = catcher.errors();
    } catch (const std::exception& error) {
      why = asOneLine(error.what());
    }
    console_bridge::setLogLevel(level);
  }
  // Of a link with a fault, urdfdom drops what comes after it, collision elements too, and goes on.
  if (urdf && urdf->getRoot() && why.empty()) return urdf;
  requireNoCircle(text);
  throw ConfigError("robot_description: it is not a valid URDF" +
                    (why.empty() ? std::string() : ": " + why));
}

/// urdfdom lets a link have two parents, and a circle of links beside the tree.
void requireTree(const urdf::ModelInterface& urdf) {
  std::map<std::string, std::string> joint_above;
  for (const auto& [name, joint] : urdf.joints_) {
    const auto [entry, is_new] = joint_above.emplace(joint->child_link_name, name);
    if (!is_new) {
      throw ConfigError("robot_description: link '" + entry->first + "' is the child of joint '" +
                        entry->second + "' and of joint '" + name + "'");
    }
  }
  std::set<std::string> reached;
  for (const auto& link : linksInOrder(urdf)) reached.insert(link->name);
  for (const auto& entry : urdf.links_) {
    if (reached.count(entry.first) == 0) {
      throw ConfigError("robot_description: link '" + entry.first +
                        "' is not reached from the root '" + urdf.getRoot()->name +
                        "': its joints form a circle");
    }
  }
}

}  // namespace

urdf::ModelInterfaceSharedPtr readUrdf(const std::string& text) {
  const std::string defect = xmlDefect(text);
  if (!defect.empty()) throw ConfigError("robot_description: " + defect);
  urdf::ModelInterfaceSharedPtr urdf = parse(text);
  requireTree(*urdf);
  return urdf;
}

std::vector<urdf::LinkConstSharedPtr> linksInOrder(const urdf::ModelInterface& urdf) {
  std::vector<urdf::LinkConstSharedPtr> order{urdf.getRoot()};
  for (std::size_t i = 0; i < order.size(); ++i) {
    auto children = order[i]->child_links;
    std::sort(children.begin(), children.end(),
              [](const auto& a, const auto& b) { return a->name < b->name; });
    order.insert(order.end(), children.begin(), children.end());
  }
  return order;
}

Pose toPose(const urdf::Pose& pose, const std::string& owner) {
  Pose result = Pose::Identity();
  const urdf::Rotation& q = pose.rotation;
  result.linear() = Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized().toRotationMatrix();
  result.translation() << pose.position.x, pose.position.y, pose.position.z;
  if (!isRigid(result) || result.translation().cwiseAbs().maxCoeff() > kFurthest) {
    throw ConfigError(owner + ": its origin is not finite, or beyond 1000 km");
  }
  return result;
}

}  // namespace tccm

#include "robot/urdf_reader.h"

#include <console_bridge/console.h>
#include <tinyxml2.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <boost/locale/utf.hpp>
#include <map>
#include <mutex>
#include <string_view>

#include "mesh/text.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

using tinyxml2::XMLElement;

constexpr std::size_t kSizeMax = 32U << 20U;  // bytes; a URDF has some hundred thousand
constexpr std::size_t kDepthMax = 100;        // elements within elements; a URDF has ten
constexpr std::size_t kTagMax = 64U << 10U;   // bytes of one tag with its attributes
constexpr std::size_t kAttributesMax = 100;   // of one element; a URDF has six
constexpr std::ptrdiff_t kQuotesMax = 1000;   // from one tag to the next, in text too
constexpr std::size_t kPartsMax = 10'000;     // links and joints; a URDF has a hundred
const std::string kTooDeep = "its elements are nested more than 100 deep";
constexpr double kFurthest = 1e6;  // [m]; beyond it is a slip, and sums would end at infinity

[[noreturn]] void refuse(std::ptrdiff_t line, const std::string& why) {
  throw ConfigError("robot_description: line " + std::to_string(line) + ": " + why);
}

std::ptrdiff_t lineAt(const std::string& text, std::size_t position) {
  return 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(position), '\n');
}

/// Where the text stops to be UTF-8; its size where it does not.
std::size_t endOfUtf8(const std::string& text) {
  auto end = text.begin();
  for (auto next = end; next != text.end();) {
    const auto character = boost::locale::utf::utf_traits<char>::decode(next, text.end());
    if (character == 0 || !boost::locale::utf::is_valid_codepoint(character)) break;
    end = next;
  }
  return static_cast<std::size_t>(end - text.begin());
}

/// Parsers compare each attribute of an element with all others, and each has two quotes: these are
/// counted from one tag to the next.
void requireFewAttributes(const std::string& text) {
  for (std::size_t begin = text.find('<'); begin < text.size();) {
    const std::size_t end = std::min(text.find('<', begin + 1), text.size());
    const std::string_view tag(text.data() + begin, end - begin);
    if (std::min(tag.find('>'), tag.size()) > kTagMax) {
      refuse(lineAt(text, begin), "a tag of it is longer than 64 kB");
    }
    const auto isQuote = [](char c) { return c == '"' || c == '\''; };
    if (std::count_if(tag.begin(), tag.end(), isQuote) > kQuotesMax) {
      const std::string_view name = tag.substr(1, tag.find_first_of(" \t\r\n\f\v/>") - 1);
      refuse(lineAt(text, begin), "the element <" + printable(name, 100) +
                                      "> has more than 100 attributes, or 1000 quotes behind it");
    }
    begin = end;
  }
}

/// urdfdom takes values that it cannot read for format strings, and releases a link's children by
/// recursion.
/// @param parts counts links and joints
void requireHarmless(const XMLElement& element, std::size_t depth, std::size_t& parts) {
  const int line = element.GetLineNum();
  const std::string name = element.Name();
  if (depth > kDepthMax) refuse(line, kTooDeep);
  if ((name == "link" || name == "joint") && ++parts > kPartsMax) {
    refuse(line, "it has more than 10000 links and joints");
  }
  const std::string owner = "the element <" + printable(name, 100) + "> has ";
  std::size_t attributes = 0;
  const auto* attribute = element.FirstAttribute();
  for (; attribute != nullptr; attribute = attribute->Next()) {
    if (++attributes > kAttributesMax) refuse(line, owner + "more than 100 attributes");
    const bool names_file = name == "mesh" || name == "texture";
    if (!names_file && std::string_view(attribute->Value()).find('%') != std::string_view::npos) {
      refuse(line, owner + "a percent sign in an attribute");
    }
  }
  const XMLElement* child = element.FirstChildElement();
  for (; child != nullptr; child = child->NextSiblingElement()) {
    requireHarmless(*child, depth + 1, parts);
  }
}

/// urdfdom lets a link have two parents, and a circle of links beside the tree; where each link has
/// a parent, it finds no root, and names none of them.
void requireTree(const XMLElement& robot) {
  struct Above {
    std::string joint, parent;
  };
  const auto linkIn = [](const XMLElement* end) {
    const char* link = end == nullptr ? nullptr : end->Attribute("link");
    return std::string(link == nullptr ? "" : link);
  };
  std::map<std::string, Above> above;  // by child
  const XMLElement* joint = robot.FirstChildElement("joint");
  for (; joint != nullptr; joint = joint->NextSiblingElement("joint")) {
    const char* name = joint->Attribute("name");
    const std::string child = linkIn(joint->FirstChildElement("child"));
    const std::string parent = linkIn(joint->FirstChildElement("parent"));
    if (name == nullptr || child.empty() || parent.empty()) continue;  // urdfdom refuses it
    const auto [known, is_new] = above.emplace(child, Above{name, parent});
    if (!is_new) {
      refuse(joint->GetLineNum(), "link '" + child + "' is the child of joint '" +
                                      known->second.joint + "' and of joint '" + name + "'");
    }
  }
  std::map<std::string, std::string> seen;  // on the way up from which link
  for (const auto& start : above) {
    for (auto at = above.find(start.first); at != above.end(); at = above.find(at->second.parent)) {
      const auto [entry, is_new] = seen.emplace(at->first, start.first);
      if (is_new) continue;
      if (entry->second != start.first) break;
      throw ConfigError("robot_description: link '" + at->first +
                        "' is below itself: its joints form a circle");
    }
  }
}

/// Leaves out what says nothing about the robot.
struct Printer : tinyxml2::XMLPrinter {
  Printer() : XMLPrinter(nullptr, true) {}
  using XMLPrinter::Visit;
  bool Visit(const tinyxml2::XMLComment& /*comment*/) override { return true; }
  bool Visit(const tinyxml2::XMLUnknown& /*unknown*/) override { return true; }
};

/// The robot written anew, so that the parser behind urdfdom finds in it what was checked: that one
/// reads beyond a text that ends within a character, and takes many things for tags.
std::string checkedXml(const std::string& text) {
  if (text.size() > kSizeMax) throw ConfigError("robot_description: it is larger than 32 MB");
  requireFewAttributes(text);
  tinyxml2::XMLDocument document;
  const tinyxml2::XMLError error = document.Parse(text.data(), text.size());
  if (error != tinyxml2::XML_SUCCESS || text.find('\0') != std::string::npos) {
    const std::size_t end = endOfUtf8(text);
    if (end < text.size()) refuse(lineAt(text, end), "a byte of it is no text in UTF-8");
    const bool deep = error == tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED;
    refuse(document.ErrorLineNum(),
           deep ? kTooDeep : "it is no XML: " + std::string(document.ErrorName()));
  }
  const XMLElement* robot = document.FirstChildElement("robot");
  if (robot == nullptr) throw ConfigError("robot_description: it has no <robot>");
  std::size_t parts = 0;
  requireHarmless(*robot, 1, parts);
  requireTree(*robot);
  Printer printer;
  robot->Accept(&printer);
  const std::string checked = printer.CStr();
  if (endOfUtf8(checked) < checked.size()) {
    throw ConfigError("robot_description: a byte of it is no text in UTF-8");
  }
  return checked;
}

/// Catches what urdfdom logs while it parses: only there it says which element is wrong.
class ErrorCatcher : public console_bridge::OutputHandler {
 public:
  ErrorCatcher() {
    console_bridge::useOutputHandler(this);
    console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_ERROR);
  }
  ~ErrorCatcher() override {
    console_bridge::setLogLevel(level_);
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
    constexpr std::size_t kKept = 3;
    if (level < console_bridge::CONSOLE_BRIDGE_LOG_ERROR || count_++ >= kKept) return;
    errors_ += (errors_.empty() ? "" : "; ") + text;
  }
  [[nodiscard]] const std::string& errors() const { return errors_; }

 private:
  inline static std::mutex mutex_;
  std::lock_guard<std::mutex> lock_{mutex_};
  console_bridge::OutputHandler* previous_ = console_bridge::getOutputHandler();
  console_bridge::LogLevel level_ = console_bridge::getLogLevel();
  std::size_t count_ = 0;
  std::string errors_;
};

}  // namespace

urdf::ModelInterfaceSharedPtr readUrdf(const std::string& text) {
  const std::string checked = checkedXml(text);
  urdf::ModelInterfaceSharedPtr urdf;
  std::string why;
  ErrorCatcher catcher;
  try {
    urdf = urdf::parseURDF(checked);
    why = catcher.errors();
  } catch (const std::exception& error) {
    why = error.what();
  }
  // Of a link with a fault, urdfdom drops what comes after it, collision elements too, and goes on.
  if (urdf && urdf->getRoot() && why.empty()) return urdf;
  throw ConfigError("robot_description: it is not a valid URDF" +
                    (why.empty() ? "" : ": " + printable(why)));
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

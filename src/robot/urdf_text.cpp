#include "robot/urdf_text.h"

#include <tinyxml2.h>

#include <algorithm>
#include <boost/algorithm/string/case_conv.hpp>
#include <boost/locale/utf.hpp>
#include <cstring>
#include <locale>
#include <map>
#include <set>
#include <string_view>

#include "base/printable.h"
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
  for (const auto* a = element.FirstAttribute(); a != nullptr; a = a->Next()) {
    if (++attributes > kAttributesMax) refuse(line, owner + "more than 100 attributes");
    const bool names_file = name == "mesh" || name == "texture";
    if (!names_file && std::strchr(a->Value(), '%') != nullptr) {
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
  const auto linkAt = [](const XMLElement& joint, const char* end) {
    const XMLElement* element = joint.FirstChildElement(end);
    const char* link = element == nullptr ? nullptr : element->Attribute("link");
    return std::string(link == nullptr ? "" : link);
  };
  std::map<std::string, const XMLElement*> above;  // the joint, by child
  const XMLElement* joint = robot.FirstChildElement("joint");
  for (; joint != nullptr; joint = joint->NextSiblingElement("joint")) {
    const char* name = joint->Attribute("name");
    const std::string child = linkAt(*joint, "child");
    if (name == nullptr || child.empty() || linkAt(*joint, "parent").empty()) {
      continue;  // urdfdom refuses it
    }
    const auto [known, is_new] = above.emplace(child, joint);
    if (is_new) continue;
    refuse(joint->GetLineNum(), "link '" + child + "' is the child of joint '" +
                                    known->second->Attribute("name") + "' and of joint '" + name +
                                    "'");
  }
  std::map<std::string, std::string> seen;  // on the way up from which link
  for (const auto& start : above) {
    for (auto at = above.find(start.first); at != above.end();
         at = above.find(linkAt(*at->second, "parent"))) {
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

std::string lowered(const char* text) {
  return boost::algorithm::to_lower_copy(std::string(text), std::locale::classic());
}

/// urdfdom passes over names with capital letters, and what hangs below them.
/// @return why a child means one of `names` and is not written so; empty where none does.
std::string misspelt(const XMLElement& parent, const std::set<std::string>& names) {
  const XMLElement* child = parent.FirstChildElement();
  for (; child != nullptr; child = child->NextSiblingElement()) {
    const std::string small = lowered(child->Name());
    if (small == child->Name() || names.count(small) == 0) continue;
    return "line " + std::to_string(child->GetLineNum()) + " has <" + printable(child->Name()) +
           ">, which would be passed over: write <" + small + ">";
  }
  return {};
}

/// urdfdom takes the first geometry of a <collision> or <visual>, and the first shape in it.
/// @return why not all of it would be taken; empty where it would.
std::string surplusIn(const XMLElement& element) {
  const std::string owner = "a <" + std::string(element.Name()) + "> in line " +
                            std::to_string(element.GetLineNum()) + " has ";
  const std::string advice = ", and the first alone would be taken: give each its own <" +
                             std::string(element.Name()) + ">";
  if (std::string wrong = misspelt(element, {"geometry"}); !wrong.empty()) return wrong;
  const XMLElement* geometry = element.FirstChildElement("geometry");
  if (geometry == nullptr) return {};  // urdfdom refuses it
  if (geometry->NextSiblingElement("geometry") != nullptr) {
    return owner + "more than one <geometry>" + advice;
  }
  const XMLElement* shape = geometry->FirstChildElement();
  const XMLElement* other = shape == nullptr ? nullptr : shape->NextSiblingElement();
  if (other == nullptr) return {};
  return owner + "more than one shape, <" + printable(shape->Name(), 100) + "> and <" +
         printable(other->Name(), 100) + ">" + advice;
}

/// The first fault of a link's elements of that name.
std::string surplusOf(const XMLElement& link, const char* name) {
  if (std::string wrong = misspelt(link, {name}); !wrong.empty()) return wrong;
  const XMLElement* element = link.FirstChildElement(name);
  for (; element != nullptr; element = element->NextSiblingElement(name)) {
    if (std::string wrong = surplusIn(*element); !wrong.empty()) return wrong;
  }
  return {};
}

/// No part of a body may be passed over in silence.
/// @return by link what would be passed over of its visual elements, which need not be its body.
std::map<std::string, std::string> requireWholeBodies(const XMLElement& robot) {
  if (const std::string wrong = misspelt(robot, {"link", "joint"}); !wrong.empty()) {
    throw ConfigError("robot_description: " + wrong);
  }
  std::map<std::string, std::string> visual_defects;
  const XMLElement* link = robot.FirstChildElement("link");
  for (; link != nullptr; link = link->NextSiblingElement("link")) {
    const char* attribute = link->Attribute("name");
    const std::string name = attribute == nullptr ? "" : attribute;
    if (const std::string wrong = surplusOf(*link, "collision"); !wrong.empty()) {
      throw ConfigError("robot_description: link '" + name + "': " + wrong);
    }
    if (const std::string wrong = surplusOf(*link, "visual"); !wrong.empty()) {
      visual_defects.emplace(name, wrong);
    }
  }
  return visual_defects;
}

}  // namespace

CheckedUrdf checkedUrdf(const std::string& text) {
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
  CheckedUrdf checked;
  checked.visual_defects = requireWholeBodies(*robot);
  Printer printer;
  robot->Accept(&printer);
  checked.xml = printer.CStr();
  if (endOfUtf8(checked.xml) < checked.xml.size()) {
    throw ConfigError("robot_description: a byte of it is no text in UTF-8");
  }
  return checked;
}

}  // namespace tccm

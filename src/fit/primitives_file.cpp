#include "fit/primitives_file.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <limits>
#include <regex>
#include <sstream>
#include <string_view>

#include "base/printable.h"
#include "config/yaml_file.h"
#include "mesh/text.h"
#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

constexpr std::size_t kTextMax = 1U << 20U;  // bytes; a robot needs some kilobytes
constexpr std::size_t kPrimitivesMax = 10'000;
constexpr double kFurthest = 1e3;      // [m]
constexpr double kLargestAngle = 1e3;  // [rad]
constexpr std::size_t kNone = std::string::npos;

/// An element of the text, with what names it in errors.
struct Element {
  YAML::Node node;
  std::string owner;

  [[nodiscard]] std::string line() const {
    const YAML::Mark mark = node.Mark();
    return mark.is_null() ? "" : " (line " + std::to_string(mark.line + 1) + ")";
  }
  [[noreturn]] void refuse(const std::string& why) const {
    throw ConfigError(owner + ": " + why + line());
  }
};

/// Follows a text's structure and keeps nothing.
class Ignore : public YAML::EventHandler {
  using Text = const std::string&;
  using Style = YAML::EmitterStyle::value;
  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override {}
  void OnScalar(const YAML::Mark&, Text, YAML::anchor_t, Text) override {}
  void OnSequenceStart(const YAML::Mark&, Text, YAML::anchor_t, Style) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark&, Text, YAML::anchor_t, Style) override {}
  void OnMapEnd() override {}
};

/// YAML::Load() passes over all behind the first document, and YAML::LoadAll() finds documents
/// without end in ",".
bool isOneDocument(const std::string& text) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  Ignore ignore;
  int documents = 0;
  while (documents < 2 && parser.HandleNextDocument(ignore)) ++documents;
  return documents == 1;
}

YAML::Node parse(const std::string& text, const std::string& owner) {
  if (text.size() > kTextMax) throw ConfigError(owner + ": it is larger than 1 MB");
  if (isNestedDeeply(text)) throw ConfigError(owner + ": its lists are nested too deeply");
  try {
    if (text.find('\0') != kNone) throw ConfigError("binary");
    if (!isOneDocument(text)) throw ConfigError("it has to be one document");
    return YAML::Load(text);
  } catch (const std::exception& error) {
    throw ConfigError(owner + ": it is no YAML: " + printable(error.what()));
  }
}

/// A plain or quoted word.
std::string wordOf(const Element& element) {
  if (!element.node.IsScalar()) element.refuse("it has to be a word");
  return element.node.Scalar();
}

/// The values of a map by their keys.
std::map<std::string, YAML::Node> valuesOf(const Element& map, const std::string& what) {
  if (!map.node.IsMap()) map.refuse("it has to be a map of " + what);
  std::map<std::string, YAML::Node> values;
  for (const auto& entry : map.node) {
    const std::string key = wordOf({entry.first, map.owner + ": a key"});
    if (!values.emplace(key, entry.second).second) {
      Element{entry.first, map.owner}.refuse("'" + printable(key) + "' is there twice");
    }
  }
  return values;
}

double numberOf(const Element& element) {
  const bool quoted = element.node.Tag() == "!";
  const auto number = element.node.IsScalar() && !quoted ? toNumber(element.node.Scalar())
                                                         : std::optional<double>();
  if (!number || !std::isfinite(*number)) element.refuse("it has to be a finite number");
  return *number;
}

/// One primitive's text.
class PrimitiveReader {
 public:
  PrimitiveReader(const YAML::Node& node, const std::string& owner)
      : element_{node, owner}, values_(valuesOf(element_, "shape, sizes, xyz and rpy")) {}

  PlacedShape read() {
    PlacedShape placed{shapeOf(wordOf(take("shape")))};
    if (values_.count("xyz") > 0) placed.pose.translation() = vector("xyz", kFurthest);
    Vector3 rpy = Vector3::Zero();
    if (values_.count("rpy") > 0) rpy = vector("rpy", kLargestAngle);
    placed.pose.linear() = (Eigen::AngleAxisd(rpy.z(), Vector3::UnitZ()) *
                            Eigen::AngleAxisd(rpy.y(), Vector3::UnitY()) *
                            Eigen::AngleAxisd(rpy.x(), Vector3::UnitX()))
                               .toRotationMatrix();
    if (!values_.empty()) {
      element_.refuse("the key '" + printable(values_.begin()->first) + "' is unknown");
    }
    try {
      validate(placed.shape, element_.owner);
    } catch (const ConfigError& error) {
      throw ConfigError(error.what() + element_.line());
    }
    return placed;
  }

 private:
  Element take(const std::string& key) {
    const auto found = values_.find(key);
    if (found == values_.end()) element_.refuse("'" + key + "' is missing");
    const Element value{found->second, element_.owner + ": " + key};
    values_.erase(found);
    return value;
  }

  Vector3 vector(const std::string& key, double largest = std::numeric_limits<double>::max()) {
    const Element list = take(key);
    if (!list.node.IsSequence() || list.node.size() != 3) {
      list.refuse("it has to be a list of three numbers");
    }
    Vector3 v;
    for (int i = 0; i < 3; ++i) v[i] = numberOf({list.node[i], list.owner});
    for (const double number : {v[0], v[1], v[2]}) {
      requireInRange(list.owner, number, -largest, largest);
    }
    return v;
  }

  Shape shapeOf(const std::string& name) {
    if (name == "box") return Box{0.5 * vector("size")};
    if (name == "sphere") return Sphere{numberOf(take("radius"))};
    const bool is_capsule = name == "capsule";
    if (!is_capsule && name != "cylinder") {
      element_.refuse("the shape '" + printable(name) +
                      "' is none of box, cylinder, capsule and sphere");
    }
    const double radius = numberOf(take("radius"));
    const double half_length = 0.5 * numberOf(take("length"));
    return is_capsule ? Shape(Capsule{radius, half_length}) : Shape(Cylinder{radius, half_length});
  }

  Element element_;
  std::map<std::string, YAML::Node> values_;
};

std::vector<PlacedShape> shapesOf(const Element& link) {
  if (!link.node.IsSequence()) link.refuse("it has to be a list of primitives");
  if (link.node.size() == 0) {
    link.refuse("it has no primitive; leave a link out by ignored_links instead");
  }
  if (link.node.size() > kPrimitivesMax) link.refuse("it has over 10000 primitives");
  std::vector<PlacedShape> shapes;
  for (const YAML::Node& node : link.node) {
    const std::string owner = link.owner + ", primitive " + std::to_string(shapes.size() + 1);
    shapes.push_back(PrimitiveReader(node, owner).read());
  }
  return shapes;
}

/// The shortest text of at most 9 decimals for a multiple of 1e-9.
std::string textOf(double billionths) {
  const auto whole = static_cast<long long>(billionths);
  const long long digits = std::abs(whole);
  std::string fraction = std::to_string(digits % 1'000'000'000);
  fraction.insert(0, 9 - fraction.size(), '0');
  fraction.erase(fraction.find_last_not_of('0') + 1);
  return (whole < 0 ? "-" : "") + std::to_string(digits / 1'000'000'000) +
         (fraction.empty() ? "" : "." + fraction);
}

std::string nearestText(double value) { return textOf(std::round(value * 1e9)); }

/// Never less than value when it is read again.
std::string textAbove(double value) {
  const double nearest = std::round(value * 1e9);
  const bool enough = toNumber(textOf(nearest)).value_or(0.0) >= value;
  return textOf(enough ? nearest : nearest + 1.0);
}

std::string listOf(const Vector3& v, std::string (*text)(double)) {
  return "[" + text(v.x()) + ", " + text(v.y()) + ", " + text(v.z()) + "]";
}

/// Roll, pitch and yaw; the roll makes up for what the yaw leaves where the pitch is a right angle.
Vector3 rpyOf(const Eigen::Matrix3d& R) {
  const double yaw = std::atan2(R(1, 0), R(0, 0));
  const double pitch = std::atan2(-R(2, 0), std::hypot(R(0, 0), R(1, 0)));
  const double roll = std::atan2(std::sin(yaw) * R(0, 2) - std::cos(yaw) * R(1, 2),
                                 std::cos(yaw) * R(1, 1) - std::sin(yaw) * R(0, 1));
  return {roll, pitch, yaw};
}

std::string sizesText(const Shape& shape) {
  const auto along = [](double radius, double half_length) {
    return "radius: " + textAbove(radius) + ", length: " + textAbove(2.0 * half_length);
  };
  if (const auto* c = std::get_if<Cylinder>(&shape)) return along(c->radius, c->half_length);
  if (const auto* c = std::get_if<Capsule>(&shape)) return along(c->radius, c->half_length);
  if (const auto* s = std::get_if<Sphere>(&shape)) return "radius: " + textAbove(s->radius);
  return "size: " + listOf(2.0 * std::get<Box>(shape).half_extents, textAbove);
}

std::string lineOf(const PlacedShape& placed, const std::string& owner) {
  validate(placed.shape, owner);
  if (!isRigid(placed.pose)) throw ConfigError(owner + ": a primitive's pose is not rigid");
  std::string line = "{shape: " + name(placed.shape) + ", " + sizesText(placed.shape);
  const std::string none = "[0, 0, 0]";
  const std::string xyz = listOf(placed.pose.translation(), nearestText);
  const std::string rpy = listOf(rpyOf(placed.pose.linear()), nearestText);
  if (xyz != none) line += ", xyz: " + xyz;
  if (rpy != none) line += ", rpy: " + rpy;
  return line + "}";
}

/// Quoted unless it is a word that YAML takes for nothing else.
std::string keyOf(const std::string& link) {
  static const std::regex kPlain("(?!(null|true|false|yes|no|y|n|on|off)$)[a-z][a-z0-9_]{0,98}",
                                 std::regex::icase);
  if (std::regex_match(link, kPlain)) return link;
  YAML::Emitter quoted;
  quoted << YAML::DoubleQuoted << link;
  return quoted.c_str();
}

std::string asComment(const std::string& comment) {
  std::istringstream lines(comment);
  std::string text;
  for (std::string line; std::getline(lines, line);) {
    text += line.empty() ? "#\n" : "# " + printable(line) + "\n";
  }
  return text;
}

}  // namespace

LinkPrimitives readPrimitives(const std::string& yaml, const std::string& owner_name) {
  const std::string owner = printable(owner_name);
  const Element document{parse(yaml, owner), owner};
  const auto values = valuesOf(document, "links");
  for (const auto& [key, value] : values) {
    if (key != "links") document.refuse("the key '" + printable(key) + "' is unknown");
  }
  if (values.empty()) document.refuse("'links' is missing");
  LinkPrimitives primitives;
  std::size_t count = 0;
  for (const auto& [link, node] : valuesOf({values.at("links"), owner + ": links"}, "links")) {
    const Element element{node, owner + ": link '" + printable(link) + "'"};
    count += (primitives[link] = shapesOf(element)).size();
    if (count > kPrimitivesMax) element.refuse("there are over 10000 primitives");
  }
  return primitives;
}

std::string writePrimitives(const LinkPrimitives& primitives, const std::string& comment) {
  std::string text = asComment(comment);
  if (primitives.empty()) return text + "links: {}\n";
  text += "links:\n";
  for (const auto& [link, shapes] : primitives) {
    text += "  " + keyOf(link) + ":\n";
    for (const PlacedShape& placed : shapes)
      text += "    - " + lineOf(placed, "link '" + printable(link) + "'") + "\n";
  }
  return text;
}

}  // namespace tccm

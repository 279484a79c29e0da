#include "nodelets/markers.h"

#include <sensor_msgs/image_encodings.h>
#include <tf2_eigen/tf2_eigen.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <sstream>
#include <string>

#include "nodelets/status_conversions.h"
#include "ros/conversions.h"

namespace tccm {
namespace {

using std_msgs::ColorRGBA;

constexpr std::size_t kTextWidth = 44;  // characters

ColorRGBA color(float r, float g, float b, float a = 1.0F) {
  ColorRGBA c;
  c.r = r;
  c.g = g;
  c.b = b;
  c.a = a;
  return c;
}

ColorRGBA magenta(float alpha) { return color(1.0F, 0.0F, 0.8F, alpha); }
ColorRGBA blue(float alpha) { return color(0.2F, 0.4F, 1.0F, alpha); }
ColorRGBA grey(float alpha) { return color(0.75F, 0.75F, 0.8F, alpha); }
ColorRGBA orange(float alpha) { return color(1.0F, 0.55F, 0.1F, alpha); }
ColorRGBA yellow() { return color(1.0F, 0.8F, 0.2F); }

ColorRGBA colorOf(const tccm_monitor::Cuboid& cuboid, int static_windows) {
  if (cuboid.held) return color(0.6F, 0.5F, 0.75F, 0.55F);
  return cuboid.dyn >= static_cast<std::uint32_t>(static_windows) ? color(0.25F, 0.75F, 0.3F)
                                                                  : color(0.9F, 0.25F, 0.15F);
}

/// One face of a cuboid: its corners as Eigen numbers them, counterclockwise seen from outside, and
/// how bright it is, so that shapes show without lights.
struct Face {
  std::array<unsigned, 4> corners;
  float brightness;
};

constexpr std::array<Face, 6> kFaces{{{{4, 5, 7, 6}, 1.0F},
                                      {{0, 2, 3, 1}, 0.4F},
                                      {{1, 3, 7, 5}, 0.85F},
                                      {{0, 4, 6, 2}, 0.65F},
                                      {{2, 6, 7, 3}, 0.75F},
                                      {{0, 1, 5, 4}, 0.75F}}};

UprightBox boxOf(const tccm_monitor::CuboidMap& map, const tccm_monitor::Cuboid& cuboid) {
  const auto column = cuboid.cell % map.cells_x;
  const auto row = cuboid.cell / map.cells_x;
  const double x = map.origin_x + column * map.cell_size;
  const double y = map.origin_y + row * map.cell_size;
  const auto top = static_cast<double>(cuboid.top);
  return {Vector3(x, y, top - static_cast<double>(cuboid.depth)),
          Vector3(x + map.cell_size, y + map.cell_size, top)};
}

void addCuboid(const UprightBox& box, const ColorRGBA& base, Marker& marker) {
  for (const Face& face : kFaces) {
    const float brightness = face.brightness;
    for (const unsigned k : {0U, 1U, 2U, 0U, 2U, 3U}) {
      const auto corner = static_cast<UprightBox::CornerType>(face.corners[k]);
      marker.points.push_back(tf2::toMsg(box.corner(corner)));
      marker.colors.push_back(
          color(base.r * brightness, base.g * brightness, base.b * brightness, base.a));
    }
  }
}

/// Appends markers that fade where they are not renewed.
class MarkerList {
 public:
  MarkerList(const std::string& frame, Time stamp) {
    prototype_.header.frame_id = frame;
    prototype_.header.stamp = toRos(stamp);
    prototype_.pose.orientation.w = 1.0;
    prototype_.lifetime = ros::Duration(1.0);
  }

  [[nodiscard]] MarkerArray take() { return std::move(list_); }

  /// The reference is valid until the next is added.
  Marker& add(const std::string& name, int type, const Vector3& scale, const ColorRGBA& color) {
    Marker& marker = list_.markers.emplace_back(prototype_);
    marker.ns = name;
    marker.type = type;
    tf2::toMsg(scale, marker.scale);
    marker.color = color;
    return marker;
  }
  /// One of several of a name.
  Marker& addNumbered(const std::string& name, int type, const Vector3& scale,
                      const ColorRGBA& color) {
    Marker& marker = add(name, type, scale, color);
    marker.id = static_cast<int>(list_.markers.size()) - 1;
    return marker;
  }
  void add(const std::string& name, const Shape& shape, const Pose& pose, const ColorRGBA& color) {
    const auto addPart = [&](int type, double z, const Vector3& scale) {
      const Pose T_shape_part(Eigen::Translation3d(0.0, 0.0, z));
      addNumbered(name, type, scale, color).pose = tf2::toMsg(pose * T_shape_part);
    };
    const auto addTube = [&](double radius, double half_length) {
      addPart(Marker::CYLINDER, 0.0, 2.0 * Vector3(radius, radius, half_length));
    };
    if (const auto* box = std::get_if<Box>(&shape)) {
      addPart(Marker::CUBE, 0.0, 2.0 * box->half_extents);
    } else if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
      addTube(cylinder->radius, cylinder->half_length);
    } else if (const auto* capsule = std::get_if<Capsule>(&shape)) {
      addTube(capsule->radius, capsule->half_length);
      for (const double z : {-capsule->half_length, capsule->half_length}) {
        addPart(Marker::SPHERE, z, Vector3::Constant(2.0 * capsule->radius));
      }
    } else if (const auto* sphere = std::get_if<Sphere>(&shape)) {
      addPart(Marker::SPHERE, 0.0, Vector3::Constant(2.0 * sphere->radius));
    }
  }
  /// All of a body in one colour, paddings included.
  void add(const std::string& name, const Body& body, const ColorRGBA& color) {
    for (std::size_t i = 0; i < body.shapes.size(); ++i) {
      const double padding_m = body.paddings_m.empty() ? 0.0 : body.paddings_m[i];
      add(name, expanded(body.shapes[i], {1.0, padding_m}), body.poses[i], color);
    }
  }

 private:
  Marker prototype_;
  MarkerArray list_;
};

ColorRGBA colorOf(std::size_t shape, const PoseFindings& findings, const Checker& checker,
                  float alpha) {
  const std::size_t link = checker.model()->shapes()[shape].link;
  const auto isAmong = [shape](const std::vector<Contact>& contacts) {
    return std::any_of(contacts.begin(), contacts.end(),
                       [shape](const Contact& c) { return c.shape == shape; });
  };
  if (isAmong(findings.contacts) || isAmong(findings.keep_out)) return magenta(alpha);
  const bool hidden = std::any_of(
      findings.links.begin(), findings.links.end(), [&](const LinkVisibility& visibility) {
        return visibility.link == link && checker.checkHere().isOccluded(visibility);
      });
  return hidden ? blue(alpha) : grey(alpha);
}

ColorRGBA colorOf(Level level) {
  if (level == Level::kOk) return color(0.3F, 0.9F, 0.4F);
  return level == Level::kSlow ? yellow() : color(1.0F, 0.2F, 0.2F);
}

/// Speed scale, the unseen share of the way ahead, and how near the nearest link is.
std::string numbersOf(const Verdict& verdict, const RobotModel& model) {
  char speed[40], unseen[40] = "", clear[120] = "";
  std::snprintf(speed, sizeof speed, "speed %.0f %%", 100.0 * verdict.speed_scale);
  if (verdict.unseen_fraction > 0.0) {
    std::snprintf(unseen, sizeof unseen, ", %.0f %% unseen", 100.0 * verdict.unseen_fraction);
  }
  const auto nearest =
      std::min_element(verdict.clearances.begin(), verdict.clearances.end(),
                       [](const auto& a, const auto& b) { return a.distance_m < b.distance_m; });
  if (nearest != verdict.clearances.end() && !std::isinf(nearest->distance_m)) {
    std::snprintf(clear, sizeof clear, "\n%.60s %.0f mm clear",
                  model.links()[nearest->link].c_str(), 1e3 * nearest->distance_m);
  }
  return std::string(speed) + unseen + clear;
}

/// In lines of so many characters or, where a word is longer, of one word: rviz centres a text, and
/// a long line would leave the view.
std::string inLines(const std::string& text, std::size_t width) {
  std::string lines, word;
  std::size_t length = 0;
  std::istringstream words(text);
  while (words >> word) {
    const bool fits = length > 0 && length + 1 + word.size() <= width;
    if (length > 0) lines += fits ? ' ' : '\n';
    length = fits ? length + 1 + word.size() : word.size();
    lines += word;
  }
  return lines;
}

/// Above the robot, wherever it is.
void addText(const Verdict& verdict, const StopCause& cause, const RobotModel& model,
             MarkerList& markers) {
  Marker& marker =
      markers.add("status", Marker::TEXT_VIEW_FACING, {0.0, 0.0, 0.05}, colorOf(verdict.level));
  marker.header.frame_id = model.rootFrames().front();
  marker.header.stamp = ros::Time();
  marker.pose.position.z = 1.65;
  const bool outlives = cause.outlives(verdict);
  const std::string& detail = outlives ? cause.detail() : verdict.detail;
  marker.text =
      std::string(name(verdict.level)) + " " + name(outlives ? cause.reason() : verdict.reason);
  if (!detail.empty()) marker.text += "\n" + inLines(detail, kTextWidth);
  if (outlives) marker.text += std::string("\nnow ") + name(verdict.reason);
  if (verdict.placed) marker.text += "\n" + numbersOf(verdict, model);
}

void addBody(const std::string& name, const PoseFindings& findings, const PoseCheck& check,
             const Checker& checker, float alpha, MarkerList& markers) {
  const auto& [shapes, links, body] = check.collisionBody();
  for (std::size_t i = 0; i < body.shapes.size(); ++i) {
    markers.add(name, body.shapes[i], body.poses[i], colorOf(shapes[i], findings, checker, alpha));
  }
}

/// @param boxes with their col as in Cuboid.msg. @param over by how much they are larger, so that
/// they show among the map's own [m].
void addBoxes(const std::string& name, const std::vector<FlaggedBox>& boxes, double over,
              MarkerList& markers) {
  if (boxes.empty()) return;
  Marker& marker =
      markers.add(name, Marker::TRIANGLE_LIST, Vector3::Ones(), color(1.0F, 1.0F, 1.0F));
  for (auto [box, col] : boxes) {
    box.min().array() -= over;
    box.max().array() += over;
    addCuboid(box, col == tccm_monitor::Cuboid::COLLISION ? magenta(1.0F) : blue(1.0F), marker);
  }
}

void addFirstContact(const WayContact& contact, const CuboidMap& map, MarkerList& markers) {
  const UprightBox box = map.box(map.cuboids[contact.contact.cuboid]);
  Marker& marker = markers.add("first contact", Marker::CUBE, box.sizes() + Vector3::Constant(0.01),
                               contact.by_margin ? yellow() : magenta(1.0F));
  marker.pose.position = tf2::toMsg(Vector3(box.center()));
}

void addUnseen(const std::vector<Vector3>& places, MarkerList& markers) {
  if (places.empty()) return;
  Marker& marker =
      markers.add("unseen ahead", Marker::CUBE_LIST, Vector3::Constant(0.015), orange(0.4F));
  for (const Vector3& p : places) marker.points.push_back(tf2::toMsg(p));
}

/// From green, just seen, over yellow to red; grey where no period says what is old.
ColorRGBA colorOfAge(double age_s, double too_old_s) {
  if (too_old_s <= 0.0) return grey(1.0F);
  const auto share = static_cast<float>(std::clamp(age_s / too_old_s, 0.0, 1.0));
  return color(std::min(1.0F, 2.0F * share), std::min(1.0F, 2.0F - 2.0F * share), 0.1F);
}

void addEvidenceAges(const Checker& checker, MarkerList& markers) {
  const double too_old_s =
      checker.config().evidence.stop_periods * toSeconds(checker.map()->look_period);
  const UsedBody& used = checker.checkHere().collisionBody();
  for (const LinkEvidence& link : checker.evidence().findings().links) {
    const auto first = std::find(used.links.begin(), used.links.end(), link.link);
    if (first == used.links.end()) continue;
    const Pose& pose = used.body.poses[static_cast<std::size_t>(first - used.links.begin())];
    char text[16] = "?";
    if (link.age_s) std::snprintf(text, sizeof text, "%.1f s", *link.age_s);
    Marker& marker =
        markers.addNumbered("evidence age", Marker::TEXT_VIEW_FACING, {0.0, 0.0, 0.03},
                            link.age_s ? colorOfAge(*link.age_s, too_old_s) : orange(1.0F));
    marker.pose.position = tf2::toMsg(Vector3(pose.translation() + 0.08 * Vector3::UnitZ()));
    marker.text = text;
  }
}

/// Each in its own frame, so that it shows before the robot can be placed.
void addKeepOut(const Verdict& verdict, const Checker& checker, const std::string& fixed_frame,
                MarkerList& markers) {
  const auto touches = [&verdict](std::size_t region) {
    const std::vector<Contact>& contacts = verdict.now.keep_out;
    return std::any_of(contacts.begin(), contacts.end(),
                       [region](const Contact& contact) { return contact.cuboid == region; });
  };
  const std::vector<KeepOutRegion>& regions = checker.keepOut();
  for (std::size_t i = 0; i < regions.size(); ++i) {
    const KeepOutRegion& region = regions[i];
    const std::string& frame = region.frame.empty() ? fixed_frame : region.frame;
    const Vector3 size = 2.0 * region.box.half_extents;
    const auto place = [&](Marker& marker) {
      marker.header.frame_id = frame;
      if (frame != fixed_frame) marker.header.stamp = ros::Time();
      marker.pose = tf2::toMsg(region.T_frame_box);
    };
    place(markers.addNumbered("keep out", Marker::CUBE, size,
                              touches(i) ? magenta(0.3F) : color(0.9F, 0.3F, 0.1F, 0.2F)));
    Marker& text = markers.addNumbered("keep out names", Marker::TEXT_VIEW_FACING, {0.0, 0.0, 0.05},
                                       color(1.0F, 0.6F, 0.4F));
    place(text);
    text.text = region.name;
  }
}

}  // namespace

Marker toMarker(const tccm_monitor::CuboidMap& map, CuboidLayer layer, int static_windows) {
  Marker marker;
  const bool held = layer == CuboidLayer::kHeld;
  marker.header = map.header;
  marker.ns = held ? "held cuboids" : "cuboids";
  marker.type = Marker::TRIANGLE_LIST;
  marker.pose.orientation.w = 1.0;
  marker.scale.x = marker.scale.y = marker.scale.z = 1.0;
  marker.color = color(1.0F, 1.0F, 1.0F);
  for (const tccm_monitor::Cuboid& cuboid : map.cuboids) {
    if ((cuboid.held != 0) != held) continue;
    addCuboid(boxOf(map, cuboid), colorOf(cuboid, static_windows), marker);
  }
  marker.action = marker.points.empty() ? Marker::DELETE : Marker::ADD;
  return marker;
}

MarkerArray toMarkers(const Verdict& verdict, const StopCause& cause, const Checker& checker,
                      const std::string& frame) {
  MarkerList markers(frame, verdict.stamp);
  if (cause.outlives(verdict)) addBoxes("cause of the stop", cause.boxes(), 0.01, markers);
  if (verdict.placed) {
    addBody("now", verdict.now, checker.checkHere(), checker, 0.3F, markers);
    addBody("ahead", verdict.ahead, checker.checkAhead(), checker, 0.1F, markers);
    markers.add("occlusion", checker.checkHere().occlusionBody().body,
                color(0.3F, 0.8F, 0.5F, 0.25F));
    addBoxes("flagged cuboids", flaggedBoxes(verdict, *checker.map()), 0.0005, markers);
    if (verdict.first_contact) addFirstContact(*verdict.first_contact, *checker.map(), markers);
    addUnseen(checker.evidence().unseenPlaces(), markers);
    addEvidenceAges(checker, markers);
  }
  for (std::size_t i = 0; i < checker.exemptions().size(); ++i) {
    const Exemption& exemption = checker.exemptions()[i];
    const std::optional<Pose> pose = checker.regionPose(i);
    if (!pose || exemption.state != Exemption::State::kInForce) continue;
    markers.add("exemptions", exemption.region.shape, *pose, color(0.2F, 0.9F, 0.9F, 0.3F));
  }
  addKeepOut(verdict, checker, frame, markers);
  addText(verdict, cause, *checker.model(), markers);
  return markers.take();
}

MarkerArray toMarkers(const BodySample& sample, const std::string& frame) {
  MarkerList markers(frame, sample.stamp);
  markers.add("self filter", sample.body, color(0.95F, 0.85F, 0.2F, 0.2F));
  return markers.take();
}

sensor_msgs::Image toImage(const ZBuffer& picture) {
  sensor_msgs::Image image;
  image.encoding = sensor_msgs::image_encodings::RGB8;
  image.width = static_cast<std::uint32_t>(picture.grid().columns());
  image.height = static_cast<std::uint32_t>(picture.grid().rows());
  image.step = 3 * image.width;
  image.data.assign(static_cast<std::size_t>(image.step) * image.height, 0);
  std::uint8_t* out = image.data.data();
  for (int row = picture.grid().rows() - 1; row >= 0; --row) {
    for (int column = picture.grid().columns() - 1; column >= 0; --column, out += 3) {
      const ZBuffer::Pixel& pixel = picture.pixel(row, column);
      if (std::isinf(pixel.depth)) continue;
      const auto near =
          static_cast<std::uint8_t>(std::clamp(255.0F - 80.0F * pixel.depth, 60.0F, 255.0F));
      out[0] = pixel.covered ? 40 : near;
      out[1] = pixel.covered ? 80 : near;
      out[2] = pixel.covered ? 255 : near;
    }
  }
  return image;
}

}  // namespace tccm

#include "nodelets/markers.h"

#include <sensor_msgs/image_encodings.h>
#include <tf2_eigen/tf2_eigen.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "ros/conversions.h"

namespace tccm {
namespace {

using std_msgs::ColorRGBA;
using visualization_msgs::Marker;

ColorRGBA color(float r, float g, float b, float a = 1.0F) {
  ColorRGBA c;
  c.r = r;
  c.g = g;
  c.b = b;
  c.a = a;
  return c;
}

ColorRGBA shaded(const ColorRGBA& c, float brightness) {
  return color(c.r * brightness, c.g * brightness, c.b * brightness, c.a);
}

ColorRGBA magenta(float alpha) { return color(1.0F, 0.0F, 0.8F, alpha); }
ColorRGBA blue(float alpha) { return color(0.2F, 0.4F, 1.0F, alpha); }

ColorRGBA colorOf(const tccm_monitor::Cuboid& cuboid, int static_windows) {
  if (cuboid.held) return color(0.6F, 0.5F, 0.75F, 0.55F);
  return cuboid.dyn >= static_cast<std::uint32_t>(static_windows) ? color(0.25F, 0.75F, 0.3F)
                                                                  : color(0.9F, 0.25F, 0.15F);
}

geometry_msgs::Point point(double x, double y, double z) {
  geometry_msgs::Point p;
  p.x = x;
  p.y = y;
  p.z = z;
  return p;
}

/// One face of a cuboid: its corners as bits x, y, z, counterclockwise seen from outside, and how
/// bright it is, so that shapes show without lights.
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
  const double x = map.origin_x + (cuboid.cell % map.cells_x) * map.cell_size;
  const double y = map.origin_y + (cuboid.cell / map.cells_x) * map.cell_size;
  const auto top = static_cast<double>(cuboid.top);
  return {Vector3(x, y, top - static_cast<double>(cuboid.depth)),
          Vector3(x + map.cell_size, y + map.cell_size, top)};
}

void addCuboid(const UprightBox& box, const ColorRGBA& base, Marker& marker) {
  for (const Face& face : kFaces) {
    const ColorRGBA c = shaded(base, face.brightness);
    for (const unsigned k : {0U, 1U, 2U, 0U, 2U, 3U}) {
      const unsigned corner = face.corners[k];
      marker.points.push_back(point((corner & 1U ? box.max() : box.min()).x(),
                                    (corner & 2U ? box.max() : box.min()).y(),
                                    (corner & 4U ? box.max() : box.min()).z()));
      marker.colors.push_back(c);
    }
  }
}

/// Appends the markers of one primitive.
class ShapeMarkers {
 public:
  ShapeMarkers(Marker prototype, const Pose& pose, std::vector<Marker>& markers)
      : prototype_(std::move(prototype)), pose_(pose), markers_(markers) {}

  void operator()(const Box& box) { add(Marker::CUBE, Pose::Identity(), 2.0 * box.half_extents); }
  void operator()(const Cylinder& c) {
    add(Marker::CYLINDER, Pose::Identity(), {2.0 * c.radius, 2.0 * c.radius, 2.0 * c.half_length});
  }
  void operator()(const Capsule& c) {
    (*this)(Cylinder{c.radius, c.half_length});
    for (const double z : {-c.half_length, c.half_length}) {
      add(Marker::SPHERE, Pose(Eigen::Translation3d(0.0, 0.0, z)),
          Vector3::Constant(2.0 * c.radius));
    }
  }
  void operator()(const Sphere& s) {
    add(Marker::SPHERE, Pose::Identity(), Vector3::Constant(2.0 * s.radius));
  }

 private:
  void add(int type, const Pose& T_shape_part, const Vector3& scale) {
    Marker marker = prototype_;
    marker.type = type;
    marker.id = static_cast<int>(markers_.size());
    marker.pose = tf2::toMsg(pose_ * T_shape_part);
    marker.scale.x = scale.x();
    marker.scale.y = scale.y();
    marker.scale.z = scale.z();
    markers_.push_back(marker);
  }

  Marker prototype_;
  Pose pose_;
  std::vector<Marker>& markers_;
};

ColorRGBA colorOf(std::size_t shape, const PoseFindings& findings, const Checker& checker,
                  float alpha) {
  const std::size_t link = checker.model()->shapes()[shape].link;
  const bool touches = std::any_of(findings.contacts.begin(), findings.contacts.end(),
                                   [shape](const Contact& c) { return c.shape == shape; });
  if (touches) return magenta(alpha);
  const bool hidden = std::any_of(
      findings.links.begin(), findings.links.end(), [&](const LinkVisibility& visibility) {
        return visibility.link == link && checker.checkHere().isOccluded(visibility);
      });
  return hidden ? blue(alpha) : color(0.75F, 0.75F, 0.8F, alpha);
}

void addBody(const PoseFindings& findings, const PoseCheck& check, const Checker& checker,
             Marker prototype, float alpha, visualization_msgs::MarkerArray& markers) {
  const auto& [shapes, links, body] = check.collisionBody();
  for (std::size_t i = 0; i < body.shapes.size(); ++i) {
    prototype.color = colorOf(shapes[i], findings, checker, alpha);
    std::visit(ShapeMarkers(prototype, body.poses[i], markers.markers), body.shapes[i]);
  }
}

/// All of a body in one colour.
void addBody(const Body& body, Marker prototype, const ColorRGBA& body_color,
             visualization_msgs::MarkerArray& markers) {
  prototype.color = body_color;
  for (std::size_t i = 0; i < body.shapes.size(); ++i) {
    const double padding = body.paddings_m.empty() ? 0.0 : body.paddings_m[i];
    std::visit(ShapeMarkers(prototype, body.poses[i], markers.markers),
               expanded(body.shapes[i], Expansion{1.0, padding}));
  }
}

Marker prototypeOf(const std::string& name, const std::string& frame, Time stamp) {
  Marker prototype;
  prototype.header.frame_id = frame;
  prototype.header.stamp = toRos(stamp);
  prototype.ns = name;
  prototype.pose.orientation.w = 1.0;
  prototype.lifetime = ros::Duration(1.0);
  return prototype;
}

const char* nameOf(Level level) {
  switch (level) {
    case Level::kOk:
      return "OK";
    case Level::kSlow:
      return "SLOW";
    case Level::kStop:
      return "STOP";
    case Level::kFault:
      return "FAULT";
  }
  return "?";
}

ColorRGBA colorOf(Level level) {
  if (level == Level::kOk) return color(0.3F, 0.9F, 0.4F);
  return level == Level::kSlow ? color(1.0F, 0.8F, 0.2F) : color(1.0F, 0.2F, 0.2F);
}

/// Speed scale, the unseen share of the way ahead, and how near the nearest link is.
std::string numbersOf(const Verdict& verdict, const RobotModel& model) {
  char text[120];
  std::snprintf(text, sizeof text, "speed %.0f %%", 100.0 * verdict.speed_scale);
  std::string numbers = text;
  if (verdict.unseen_fraction > 0.0) {
    std::snprintf(text, sizeof text, ", %.0f %% unseen", 100.0 * verdict.unseen_fraction);
    numbers += text;
  }
  const auto nearest =
      std::min_element(verdict.clearances.begin(), verdict.clearances.end(),
                       [](const auto& a, const auto& b) { return a.distance_m < b.distance_m; });
  if (nearest == verdict.clearances.end() || std::isinf(nearest->distance_m)) return numbers;
  std::snprintf(text, sizeof text, "\n%.60s %.0f mm clear", model.links()[nearest->link].c_str(),
                1e3 * nearest->distance_m);
  return numbers + text;
}

Marker textOf(const Verdict& verdict, const RobotModel& model, Marker prototype) {
  prototype.ns = "status";
  prototype.id = 0;
  prototype.type = Marker::TEXT_VIEW_FACING;
  prototype.header.frame_id = model.rootLinks().front();
  prototype.header.stamp = ros::Time();
  prototype.pose.position.z = 1.7;
  prototype.pose.orientation.w = 1.0;
  prototype.scale.z = 0.05;
  prototype.color = colorOf(verdict.level);
  prototype.text = std::string(nameOf(verdict.level)) + " " + name(verdict.reason);
  if (!verdict.detail.empty()) prototype.text += "\n" + verdict.detail;
  if (verdict.placed) prototype.text += "\n" + numbersOf(verdict, model);
  return prototype;
}

/// The cuboid that is touched first on the way ahead.
Marker contactOf(const WayContact& contact, const CuboidMap& map, Marker prototype) {
  const UprightBox box = map.box(map.cuboids[contact.contact.cuboid]);
  prototype.ns = "first contact";
  prototype.id = 0;
  prototype.type = Marker::CUBE;
  prototype.pose = tf2::toMsg(Pose(Eigen::Translation3d(box.center())));
  const Vector3 size = box.sizes() + Vector3::Constant(0.01);
  prototype.scale.x = size.x();
  prototype.scale.y = size.y();
  prototype.scale.z = size.z();
  prototype.color = contact.by_margin ? color(1.0F, 0.8F, 0.2F) : magenta(1.0F);
  return prototype;
}

/// The cuboids that links touch, or are hidden behind, at the present pose or at the end of the
/// way.
Marker flaggedOf(const Verdict& verdict, const CuboidMap& map, Marker prototype) {
  constexpr double kOver = 0.0005;  // [m] so that they show over the map's own
  prototype.ns = "flagged cuboids";
  prototype.id = 0;
  prototype.type = Marker::TRIANGLE_LIST;
  prototype.scale.x = prototype.scale.y = prototype.scale.z = 1.0;
  prototype.color = color(1.0F, 1.0F, 1.0F);
  const auto add = [&](std::uint32_t cuboid, const ColorRGBA& base) {
    UprightBox box = map.box(map.cuboids[cuboid]);
    box.min().array() -= kOver;
    box.max().array() += kOver;
    addCuboid(box, base, prototype);
  };
  for (const PoseFindings* found : {&verdict.now, &verdict.ahead}) {
    for (const Contact& contact : found->contacts) add(contact.cuboid, magenta(1.0F));
    for (const std::uint32_t cuboid : found->occluding_cuboids) add(cuboid, blue(1.0F));
  }
  return prototype;
}

/// Where the links are about to go although nobody has seen the place.
Marker unseenOf(const std::vector<Vector3>& places, Marker prototype) {
  prototype.ns = "unseen ahead";
  prototype.id = 0;
  prototype.type = Marker::CUBE_LIST;
  prototype.scale.x = prototype.scale.y = prototype.scale.z = 0.015;
  prototype.color = color(1.0F, 0.55F, 0.1F, 0.4F);
  for (const Vector3& p : places) prototype.points.push_back(point(p.x(), p.y(), p.z()));
  return prototype;
}

/// From green, just seen, over yellow to red; grey where no period says what is old.
ColorRGBA colorOfAge(double age_s, double too_old_s) {
  if (too_old_s <= 0.0) return color(0.75F, 0.75F, 0.8F);
  const auto share = static_cast<float>(std::clamp(age_s / too_old_s, 0.0, 1.0));
  return color(std::min(1.0F, 2.0F * share), std::min(1.0F, 2.0F - 2.0F * share), 0.1F);
}

/// At each link whose way is watched, how old what is known of it is.
void addEvidenceAges(const Checker& checker, Marker prototype,
                     visualization_msgs::MarkerArray& markers) {
  const double too_old_s =
      checker.config().evidence.stop_periods * toSeconds(checker.map()->look_period);
  const UsedBody& used = checker.checkHere().collisionBody();
  prototype.ns = "evidence age";
  prototype.type = Marker::TEXT_VIEW_FACING;
  prototype.scale.z = 0.03;
  for (const LinkEvidence& link : checker.evidence().findings().links) {
    const auto first = std::find(used.links.begin(), used.links.end(), link.link);
    if (first == used.links.end()) continue;
    const auto index = static_cast<std::size_t>(first - used.links.begin());
    const Vector3 p = used.body.poses[index].translation();
    char text[16] = "?";
    if (link.age_s) std::snprintf(text, sizeof text, "%.1f s", *link.age_s);
    prototype.id = static_cast<int>(markers.markers.size());
    prototype.pose.position = point(p.x(), p.y(), p.z() + 0.08);
    prototype.color = link.age_s ? colorOfAge(*link.age_s, too_old_s) : color(1.0F, 0.55F, 0.1F);
    prototype.text = text;
    markers.markers.push_back(prototype);
  }
}

}  // namespace

void toMarker(const tccm_monitor::CuboidMap& map, CuboidLayer layer, int static_windows,
              Marker& marker) {
  const bool held = layer == CuboidLayer::kHeld;
  marker.header = map.header;
  marker.ns = held ? "held cuboids" : "cuboids";
  marker.type = Marker::TRIANGLE_LIST;
  marker.pose.orientation.w = 1.0;
  marker.scale.x = marker.scale.y = marker.scale.z = 1.0;
  marker.color = color(1.0F, 1.0F, 1.0F);
  marker.points.clear();
  marker.colors.clear();
  for (const tccm_monitor::Cuboid& cuboid : map.cuboids) {
    if ((cuboid.held != 0) != held) continue;
    addCuboid(boxOf(map, cuboid), colorOf(cuboid, static_windows), marker);
  }
  marker.action = marker.points.empty() ? Marker::DELETE : Marker::ADD;
}

void toMarkers(const Verdict& verdict, const Checker& checker, const std::string& frame,
               visualization_msgs::MarkerArray& markers) {
  Marker prototype = prototypeOf("now", frame, verdict.stamp);
  markers.markers.clear();
  if (verdict.placed) {
    addBody(verdict.now, checker.checkHere(), checker, prototype, 0.3F, markers);
    prototype.ns = "ahead";
    addBody(verdict.ahead, checker.checkAhead(), checker, prototype, 0.1F, markers);
    prototype.ns = "occlusion";
    addBody(checker.checkHere().occlusionBody().body, prototype, color(0.3F, 0.8F, 0.5F, 0.25F),
            markers);
    const Marker flagged = flaggedOf(verdict, *checker.map(), prototype);
    if (!flagged.points.empty()) markers.markers.push_back(flagged);
    if (verdict.first_contact) {
      markers.markers.push_back(contactOf(*verdict.first_contact, *checker.map(), prototype));
    }
    const std::vector<Vector3>& unseen = checker.evidence().unseenPlaces();
    if (!unseen.empty()) markers.markers.push_back(unseenOf(unseen, prototype));
    addEvidenceAges(checker, prototype, markers);
  }
  prototype.ns = "exemptions";
  prototype.color = color(0.2F, 0.9F, 0.9F, 0.3F);
  for (const Exemption& exemption : checker.exemptions()) {
    std::visit(ShapeMarkers(prototype, exemption.region.pose, markers.markers),
               exemption.region.shape);
  }
  markers.markers.push_back(textOf(verdict, *checker.model(), prototype));
}

void toMarkers(const BodySample& sample, const std::string& frame,
               visualization_msgs::MarkerArray& markers) {
  markers.markers.clear();
  addBody(sample.body, prototypeOf("self filter", frame, sample.stamp),
          color(0.95F, 0.85F, 0.2F, 0.2F), markers);
}

void toImage(const ZBuffer& picture, sensor_msgs::Image& image) {
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
      const auto grey =
          static_cast<std::uint8_t>(std::clamp(255.0F - 80.0F * pixel.depth, 60.0F, 255.0F));
      out[0] = pixel.covered ? 40 : grey;
      out[1] = pixel.covered ? 80 : grey;
      out[2] = pixel.covered ? 255 : grey;
    }
  }
}

}  // namespace tccm

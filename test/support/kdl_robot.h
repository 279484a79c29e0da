#pragma once

#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <kdl/treefksolverpos_recursive.hpp>
#include <kdl_parser/kdl_parser.hpp>
#include <map>
#include <set>
#include <stdexcept>
#include <string>

namespace tccm::test {

/// A robot's links as KDL places them. KDL knows no mimics: their positions are worked out here.
class KdlRobot {
 public:
  explicit KdlRobot(const std::string& urdf) : urdf_(urdf::parseURDF(urdf)) {
    if (!urdf_ || !kdl_parser::treeFromUrdfModel(*urdf_, tree_)) {
      throw std::runtime_error("no KDL tree");
    }
  }

  /// Where links are in the robot's root; joints that are not named are at 0.
  [[nodiscard]] std::map<std::string, Eigen::Isometry3d> linkPoses(
      const std::set<std::string>& links, const std::map<std::string, double>& positions) const {
    KDL::JntArray joints(tree_.getNrOfJoints());
    for (const auto& [name, element] : tree_.getSegments()) {
      if (element.segment.getJoint().getType() == KDL::Joint::None) continue;
      joints(element.q_nr) = position(element.segment.getJoint().getName(), positions);
    }
    KDL::TreeFkSolverPos_recursive solver(tree_);
    std::map<std::string, Eigen::Isometry3d> poses;
    for (const std::string& link : links) {
      KDL::Frame frame;
      if (solver.JntToCart(joints, frame, link) < 0) throw std::runtime_error("no link " + link);
      poses[link] = toEigen(frame);
    }
    return poses;
  }

  /// Where joints are after so many seconds at these velocities; at its limit a joint stays.
  [[nodiscard]] std::map<std::string, double> ahead(const std::map<std::string, double>& positions,
                                                    const std::map<std::string, double>& velocities,
                                                    double seconds) const {
    std::map<std::string, double> result;
    for (const auto& [name, now] : positions) {
      const auto joint = urdf_->getJoint(name);
      double then = now + seconds * velocities.at(name);
      const bool limited =
          joint && joint->limits &&
          (joint->type == urdf::Joint::REVOLUTE || joint->type == urdf::Joint::PRISMATIC);
      // One that is beyond its limit already stays where it is.
      if (limited && then > joint->limits->upper)
        then = std::max(joint->limits->upper, std::min(now, then));
      if (limited && then < joint->limits->lower)
        then = std::min(joint->limits->lower, std::max(now, then));
      result[name] = then;
    }
    return result;
  }

  /// Those links below (and with) a link that have a collision element.
  [[nodiscard]] std::set<std::string> solidLinksFrom(const std::string& link) const {
    std::set<std::string> links;
    addSolidLinks(*urdf_->getLink(link), links);
    return links;
  }

 private:
  static Eigen::Isometry3d toEigen(const KDL::Frame& frame) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    for (int row = 0; row < 3; ++row) {
      pose.translation()[row] = frame.p(row);
      for (int column = 0; column < 3; ++column) pose.matrix()(row, column) = frame.M(row, column);
    }
    return pose;
  }

  [[nodiscard]] double position(const std::string& joint,
                                const std::map<std::string, double>& positions) const {
    const auto& mimic = urdf_->getJoint(joint)->mimic;
    if (mimic) return mimic->multiplier * position(mimic->joint_name, positions) + mimic->offset;
    const auto found = positions.find(joint);
    return found == positions.end() ? 0.0 : found->second;
  }

  static void addSolidLinks(const urdf::Link& link, std::set<std::string>& links) {
    if (link.collision) links.insert(link.name);
    for (const auto& child : link.child_links) addSolidLinks(*child, links);
  }

  urdf::ModelInterfaceSharedPtr urdf_;
  KDL::Tree tree_;
};

}  // namespace tccm::test

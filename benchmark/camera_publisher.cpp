/// Publishes what a depth camera of 640 x 480 pixels sees of the dual-arm robot at a table, its
/// joint states and where the camera is: for benchmark/camera_load.

#include <geometry_msgs/TransformStamped.h>
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>
#include <sensor_msgs/PointCloud2.h>
#include <tf2_eigen/tf2_eigen.h>
#include <tf2_msgs/TFMessage.h>

#include <cstring>

#include "support/depth_view.h"

namespace {

sensor_msgs::PointCloud2 messageOf(const tccm::Cloud& cloud) {
  sensor_msgs::PointCloud2 message;
  message.header.frame_id = "camera_optical_frame";
  message.width = static_cast<std::uint32_t>(cloud.width);
  message.height = static_cast<std::uint32_t>(cloud.height);
  for (const char* name : {"x", "y", "z"}) {
    sensor_msgs::PointField field;
    field.name = name;
    field.offset = 4 * static_cast<std::uint32_t>(message.fields.size());
    field.datatype = sensor_msgs::PointField::FLOAT32;
    field.count = 1;
    message.fields.push_back(field);
  }
  message.point_step = 16;
  message.row_step = message.point_step * message.width;
  message.data.resize(message.point_step * cloud.points.size());
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    std::memcpy(&message.data[16 * i], cloud.points[i].data(), 12);
  }
  return message;
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "camera_publisher");
  ros::NodeHandle node;
  const tccm::test::DepthView view;
  sensor_msgs::PointCloud2 cloud = messageOf(view.camera(1).cloud);
  sensor_msgs::JointState joints;
  for (const auto& variable : view.model()->variables()) joints.name.push_back(variable.name);
  joints.position = view.positions();
  joints.velocity.assign(joints.position.size(), 0.0);
  tf2_msgs::TFMessage where;
  where.transforms.push_back(tf2::eigenToTransform(view.sensorPose()));
  where.transforms.front().header.frame_id = view.model()->rootFrames().front();
  where.transforms.front().child_frame_id = cloud.header.frame_id;

  auto tf = node.advertise<tf2_msgs::TFMessage>("/tf_static", 1, true);
  auto clouds = node.advertise<sensor_msgs::PointCloud2>("camera/points", 2);
  auto states = node.advertise<sensor_msgs::JointState>("joint_states", 10);
  tf.publish(where);
  ros::Rate rate(90.0);
  for (int i = 0; ros::ok(); ++i, rate.sleep()) {
    joints.header.stamp = ros::Time::now();
    states.publish(joints);
    if (i % 3 != 0) continue;
    cloud.header.stamp = joints.header.stamp;
    clouds.publish(cloud);
  }
  return 0;
}

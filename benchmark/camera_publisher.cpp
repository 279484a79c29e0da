/// Publishes what a depth camera of 640 x 480 pixels sees of the dual-arm robot at a table, its
/// joint states and where the camera is: for benchmark/camera_load.

#include <geometry_msgs/TransformStamped.h>
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>
#include <sensor_msgs/PointCloud2.h>
#include <tf2_eigen/tf2_eigen.h>
#include <tf2_msgs/TFMessage.h>

#include "cloud_message.h"
#include "support/depth_view.h"

int main(int argc, char** argv) {
  ros::init(argc, argv, "camera_publisher");
  ros::NodeHandle node;
  const tccm::test::DepthView view;
  sensor_msgs::PointCloud2 cloud = tccm::messageOf(view.camera(1).cloud);
  cloud.header.frame_id = "camera_optical_frame";
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

# Messages, and what catkin and others have to know of the package.

# catkin caches the tests' environment while it is found. What is not there by then is cached as an
# empty PYTHONPATH, and Python tests would not find this package's messages.
if(NOT CATKIN_DEVEL_PREFIX)
  file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/devel/lib/python3/dist-packages)
endif()
find_package(catkin REQUIRED COMPONENTS
  actionlib actionlib_msgs diagnostic_msgs diagnostic_updater dynamic_reconfigure geometry_msgs
  message_generation nodelet pcl_conversions pluginlib rosbag_storage roscpp rosgraph_msgs roslib
  sensor_msgs std_msgs std_srvs tf2 tf2_eigen tf2_msgs tf2_ros topic_tools trajectory_msgs
  visualization_msgs)
include(cmake/control_msgs.cmake)
include(cmake/moveit_msgs.cmake)
include(cmake/rviz.cmake)

add_message_files(FILES
  AttachedObject.msg AttachedObjects.msg CheckerCall.msg CheckerState.msg CloudScan.msg Cuboid.msg CuboidFlag.msg
  CuboidMap.msg CuboidMapChange.msg Exemption.msg KeepOutRegion.msg LinkStatus.msg Looks.msg
  MonitorStatus.msg MotionPermission.msg Primitive.msg ScanReport.msg ScanTrace.msg)
add_service_files(FILES
  AddExemption.srv AttachObject.srv CheckState.srv CheckTrajectory.srv DetachObject.srv
  GetCuboidMap.srv LiftExemption.srv ListExemptions.srv ReportGoal.srv
  SetKeepOut.srv)
generate_messages(DEPENDENCIES geometry_msgs sensor_msgs std_msgs trajectory_msgs)

find_package(Eigen3 REQUIRED)  # says where it is as EIGEN3_INCLUDE_DIRS
catkin_package(
  INCLUDE_DIRS include
  LIBRARIES tccm_monitor_core
  CATKIN_DEPENDS geometry_msgs message_runtime sensor_msgs std_msgs trajectory_msgs
  DEPENDS EIGEN3)

install(DIRECTORY launch config docs rviz DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION})
install(FILES nodelets.xml rviz_plugins.xml README.md LICENSE CHANGELOG.rst
  DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION})
catkin_install_python(PROGRAMS scripts/demo_report scripts/draw_evaluation scripts/draw_primitives
  scripts/draw_trials scripts/draw_what_if scripts/evaluate_all scripts/play_bag
  scripts/spread_trials
  DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
install(DIRECTORY scripts/evaluation_report scripts/evaluations scripts/spreading
  DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION}
  PATTERN __pycache__ EXCLUDE)
if(CATKIN_ENABLE_TESTING)
  find_package(roslaunch REQUIRED)
  roslaunch_add_file_check(launch)
endif()

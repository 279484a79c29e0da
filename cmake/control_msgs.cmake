# The action control_msgs/FollowJointTrajectory, for C++ and Python: of ROS's package control_msgs
# where that is installed. Where it is not, as on Debian, the same messages are generated from
# interfaces/control_msgs into the devel space; they are not installed, for they are not ours.
find_package(control_msgs QUIET)
set(generated_before ${CMAKE_CURRENT_BINARY_DIR}/interfaces/control_msgs)
set(control_msgs_devel ${CATKIN_DEVEL_PREFIX}/include/control_msgs
  ${CATKIN_DEVEL_PREFIX}/${PYTHON_INSTALL_DIR}/control_msgs ${CATKIN_DEVEL_PREFIX}/share/control_msgs)
if(control_msgs_FOUND)
  # What was generated before it was installed would be found first. The devel space may also be one
  # that both share, and all in it the package's own.
  string(FIND "${control_msgs_DIR}" "${CATKIN_DEVEL_PREFIX}/" shared_devel)
  if(EXISTS "${generated_before}" AND NOT shared_devel EQUAL 0)
    file(REMOVE_RECURSE ${generated_before} ${control_msgs_devel})
  endif()
else()
  # What is excluded from all is not installed either.
  add_subdirectory(interfaces/control_msgs EXCLUDE_FROM_ALL)
  set(control_msgs_INCLUDE_DIRS ${CATKIN_DEVEL_PREFIX}/include)
  set(control_msgs_EXPORTED_TARGETS
    control_msgs_generate_messages_cpp control_msgs_generate_messages_py)
endif()

add_custom_target(tccm_monitor_control_msgs_generated ALL)
if(control_msgs_EXPORTED_TARGETS)
  add_dependencies(tccm_monitor_control_msgs_generated ${control_msgs_EXPORTED_TARGETS})
endif()
add_library(tccm_monitor_control_msgs INTERFACE)
target_include_directories(tccm_monitor_control_msgs SYSTEM INTERFACE ${control_msgs_INCLUDE_DIRS})
add_dependencies(tccm_monitor_control_msgs tccm_monitor_control_msgs_generated)

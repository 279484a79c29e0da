# MoveIt's messages, for moveit_attached_objects alone. Debian has none, and nothing else needs them.
find_package(moveit_msgs QUIET)
if(moveit_msgs_FOUND)
  message(STATUS "moveit_msgs found: moveit_attached_objects is built")
else()
  message(STATUS "moveit_msgs not found: moveit_attached_objects is left out")
endif()

# The core alone, without ROS and catkin: others find it by find_package(tccm_monitor).
include(CMakePackageConfigHelpers)
include(CTest)
include(GNUInstallDirs)

set(TCCM_MONITOR_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/tccm_monitor)
file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/tccm_monitorConfig.cmake "\
include(CMakeFindDependencyMacro)
find_dependency(Eigen3)
include(\${CMAKE_CURRENT_LIST_DIR}/tccm_monitorTargets.cmake)
")
write_basic_package_version_file(tccm_monitorConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/tccm_monitorConfig.cmake
  ${CMAKE_CURRENT_BINARY_DIR}/tccm_monitorConfigVersion.cmake DESTINATION ${TCCM_MONITOR_CMAKE_DIR})
install(EXPORT tccm_monitor NAMESPACE tccm_monitor:: FILE tccm_monitorTargets.cmake
  DESTINATION ${TCCM_MONITOR_CMAKE_DIR})

/// The three nodelets in one process of their own, for those who avoid nodelet managers.

#include <nodelet/loader.h>
#include <ros/ros.h>

#include <string>
#include <vector>

int main(int argc, char** argv) {
  ros::init(argc, argv, "tccm_monitor");
  ros::NodeHandle node;
  nodelet::Loader loader(node);
  const std::vector<std::pair<std::string, std::string>> nodelets{
      {"tilt_scan_assembler", "tccm_monitor/TiltScanAssembler"},
      {"tccm_mapper", "tccm_monitor/TccmMapper"},
      {"collision_checker", "tccm_monitor/CollisionChecker"}};
  for (const auto& [name, type] : nodelets) {
    if (!loader.load(node.resolveName(name), type, ros::names::getRemappings(), {})) return 1;
  }
  ros::spin();
  return 0;
}

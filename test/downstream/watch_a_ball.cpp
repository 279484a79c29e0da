// A laser that nods looks at a table 0.4 m high; a ball hangs over it, and is let down after 3 s.
#include <tccm_monitor/monitor.h>

#include <cmath>
#include <cstdio>

const char* const kRobot = R"(<robot name="ball_on_a_slide">
  <link name="base"/>
  <link name="ball"><collision><geometry><sphere radius="0.05"/></geometry></collision></link>
  <joint name="height" type="prismatic"><parent link="base"/><child link="ball"/>
    <origin xyz="0.8 0 0"/><axis xyz="0 0 1"/>
    <limit lower="0" upper="2" effort="1" velocity="1"/></joint>
</robot>)";

int main() {
  tccm::Monitor monitor = tccm::loadMonitor("", kRobot);  // all parameters have their defaults
  tccm::Reason last = tccm::Reason::kInternal;
  for (double seconds = 0.0; seconds < 3.5; seconds += 0.02) {
    const tccm::Time now(tccm::fromSeconds(100.0 + seconds));
    tccm::LaserScan scan{now, -0.5, 0.01, tccm::Duration(0), 0.05, 4.0, {}};
    tccm::Pose T_fixed_sensor = tccm::Pose::Identity();
    T_fixed_sensor.translation().z() = 1.0;
    T_fixed_sensor.rotate(
        Eigen::AngleAxisd(0.65 + 0.25 * std::sin(2.0 * M_PI * seconds), tccm::Vector3::UnitY()));
    for (double angle = -0.5; angle <= 0.5; angle += 0.01) {
      const tccm::Vector3 beam(std::cos(angle), std::sin(angle), 0.0);
      scan.ranges.push_back(static_cast<float>(-0.6 / (T_fixed_sensor.linear() * beam).z()));
    }
    tccm::PosePath sensor, base;  // where they are while the scan is taken
    sensor.add(now, T_fixed_sensor);
    base.add(now, tccm::Pose::Identity());
    monitor.addJoints(now, now, {"height"}, {seconds < 3.0 ? 0.7 : 0.42}, {});
    monitor.addScan(now, scan, sensor, {base});
    monitor.checker().setRootPose(0, now, tccm::Pose::Identity(), true);
    const tccm::Verdict& verdict = monitor.checker().check(now);
    if (verdict.reason == last) continue;
    last = verdict.reason;
    std::printf("%.2f s: %s: %s %s\n", seconds, verdict.stop ? "stop" : "go", name(last),
                verdict.detail.c_str());
  }
}

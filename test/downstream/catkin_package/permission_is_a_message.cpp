#include <tccm_monitor/MotionPermission.h>

#include <cstdio>

int main() {
  const tccm_monitor::MotionPermission permission;
  std::puts(permission.permitted != 0 ? "go" : "stop");
}

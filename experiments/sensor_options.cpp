#include "experiments/sensor_options.h"

namespace tccm::simulation {

void SensorOptions::declare(CLI::App& app) {
  app.add_option("--sensors", sensors, "any of laser, camera, lidar")
      ->delimiter(',')
      ->check(CLI::IsMember(sensorNames()))
      ->capture_default_str();
  app.add_option("--camera", camera, "where the camera is")
      ->check(CLI::IsMember(cameraPlaces()))
      ->capture_default_str();
  app.add_option("--camera-width", camera_width,
                 "of its picture, at the same field of view; fewer pixels take less time")
      ->check(CLI::Range(64, 1280))
      ->capture_default_str();
  app.add_option("--camera-mixed-share", camera_mixed_share,
                 "of its pixels that straddle two surfaces, that show something in between")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
}

SensorChoice SensorOptions::choice() const {
  SensorChoice choice;
  choice.kinds = sensorKinds(sensors);
  choice.clouds.camera_mount = cameraMount(camera);
  choice.clouds.camera.mixed_share = camera_mixed_share;
  choice.clouds.camera.pinhole = Pinhole::ofWidth(camera_width);
  return choice;
}

}  // namespace tccm::simulation

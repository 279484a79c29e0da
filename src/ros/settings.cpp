#include "ros/settings.h"

#include "tccm_monitor/config_error.h"

namespace tccm {
namespace {

void refuseUnknown(const Parameters& parameters) {
  const auto unknown = parameters.unknownKeys();
  if (!unknown.empty()) {
    throw ConfigError(parameters.owner() + "/" + unknown.front() + ": there is no such parameter");
  }
}

void read(Parameters& parameters, const LinkUse::Keys& keys, LinkUse& use) {
  parameters.read(keys.links, use.links);
  parameters.read(keys.ignored, use.ignored);
  parameters.read(keys.scale, use.expansion.scale);
  parameters.read(keys.padding, use.expansion.padding_m);
  for (Parameters& entry : parameters.readList(keys.exceptions)) {
    LinkUse::Exception exception;
    entry.read("links", exception.links);
    entry.read("scale", exception.scale);
    entry.read("padding_m", exception.padding_m);
    refuseUnknown(entry);
    use.exceptions.push_back(exception);
  }
}

void read(Parameters& parameters, JointStates::Config& config) {
  parameters.read("joint_gap_max_s", config.gap_max_s);
  parameters.read("joint_velocity_baseline_s", config.velocity_baseline_s);
  parameters.read("joint_samples_max", config.samples_max);
}

void read(Parameters& parameters, Grid::Config& config) {
  parameters.read("area_origin_x_m", config.origin_x_m);
  parameters.read("area_origin_y_m", config.origin_y_m);
  parameters.read("area_size_x_m", config.size_x_m);
  parameters.read("area_size_y_m", config.size_y_m);
  parameters.read("height_min_m", config.height_min_m);
  parameters.read("height_max_m", config.height_max_m);
  parameters.read("cell_size_m", config.cell_size_m);
  parameters.read("height_quantum_m", config.height_quantum_m);
}

void read(Parameters& parameters, PoseCheck::Config& config) {
  read(parameters, kCollisionKeys, config.collision_use);
  parameters.read("support_points", config.collision.support_points);
  parameters.read("support_height_m", config.collision.support_height_m);
  parameters.read("contacts_max", config.collision.contacts_max);
  parameters.read("check_occlusion", config.check_occlusion);
  read(parameters, kOcclusionKeys, config.occlusion_use);
  parameters.read("occlusion_resolution_rad", config.occlusion.resolution_rad);
  parameters.read("occlusion_margin_m", config.occlusion.margin_m);
  parameters.read("occlusion_hidden_fraction", config.occlusion.hidden_fraction);
  parameters.read("occlusion_silhouette_min_pixels", config.occlusion.silhouette_min_pixels);
}

void read(Parameters& parameters, CheckInputs::Config& config) {
  read(parameters, config.joints);
  parameters.read("joint_timeout_s", config.joint_timeout_s);
  parameters.read("transform_timeout_s", config.transform_timeout_s);
  parameters.read("scan_timeout_periods", config.scan_timeout_periods);
  parameters.read("map_age_max_s", config.map_age_max_s);
  parameters.read("future_max_s", config.future_max_s);
  parameters.read("transform_future_max_s", config.transform_future_max_s);
}

void read(Parameters& parameters, WayAhead::Config& config) {
  parameters.read("horizon_s", config.horizon_s);
  parameters.read("way_step_m", config.step_m);
  parameters.read("stop_time_s", config.stop_time_s);
  parameters.read("reaction_time_s", config.reaction_time_s);
  parameters.read("deceleration_mps2", config.deceleration_mps2);
  parameters.read("margin_max_m", config.margin_max_m);
  parameters.read("slow_scale_min", config.slow_scale_min);
  parameters.read("moving_out_scale", config.moving_out_scale);
}

void read(Parameters& parameters, EvidenceCheck::Config& config) {
  parameters.read("evidence_links", config.links);
  parameters.read("evidence_margin_m", config.margin_m);
  parameters.read("evidence_slow_periods", config.slow_periods);
  parameters.read("evidence_stop_periods", config.stop_periods);
  parameters.read("evidence_old_fraction_max", config.old_fraction_max);
  parameters.read("unseen_fraction_max", config.unseen_fraction_max);
  parameters.read("unseen_volume_min_m3", config.unseen_volume_min_m3);
  parameters.read("unseen_slow_scale", config.slow_scale);
  parameters.read("unseen_stops", config.unseen_stops);
}

void read(Parameters& parameters, Checker::Config& config) {
  read(parameters, config.pose);
  read(parameters, config.inputs);
  read(parameters, config.way);
  read(parameters, config.evidence);
  parameters.read("appear_distance_m", config.governed_speed.appear_distance_m);
  parameters.read("appear_look_margin_m", config.governed_speed.look_margin_m);
  parameters.read("appear_place_step_m", config.governed_speed.place_step_m);
  parameters.read("commanded_speed_max_mps", config.governed_speed.speed_max_mps);
  config.governed_speed.deceleration_mps2 = config.way.deceleration_mps2;
  config.governed_speed.reaction_time_s = config.way.reaction_time_s;
  parameters.read("occlusion_stops", config.occlusion_stops);
  parameters.read("occlusion_slow_scale", config.occlusion_slow_scale);
  parameters.read("clearance_radius_m", config.clearance_radius_m);
  parameters.read("trajectory_step_m", config.trajectory_step_m);
  parameters.read("trajectory_occlusion_poses", config.trajectory_occlusion_poses);
  parameters.read("trajectory_deviation_max", config.trajectories.deviation_max);
  parameters.read("trajectory_points_max", config.trajectories.points_max);
  parameters.read("release_s", config.permission.release_s);
  parameters.read("release_checks", config.permission.release_checks);
  parameters.read("hold_until_reset", config.permission.hold_until_reset);
  parameters.read("speed_scale_rise_per_s", config.permission.speed_scale_rise_per_s);
  parameters.read("exemption_max_s", config.exemptions.duration_max_s);
  parameters.read("exemptions_max", config.exemptions.count_max);
}

YAML::Node loadFile(const std::string& path) {
  if (path.empty()) return {};
  try {
    return YAML::LoadFile(path);
  } catch (const YAML::Exception& error) {
    throw ConfigError(path + ": " + error.what());
  }
}

Parameters section(const YAML::Node& file, const std::string& name) {
  return {file && file.IsMap() ? file[name] : YAML::Node(), name};
}

void requireFrame(const std::string& frame) {
  if (frame.find_first_not_of('/') == std::string::npos) {
    throw ConfigError("fixed_frame: '" + frame + "' is no frame's name");
  }
}

}  // namespace

RobotModel::Config readRobotSettings(Parameters& parameters) {
  RobotModel::Config robot;
  parameters.read("link_groups", robot.link_groups);
  parameters.read("monitored_links", robot.monitored_links);
  parameters.read("ignored_links", robot.ignored_links);
  parameters.read("capsule_links", robot.capsule_links);
  parameters.read("visual_links", robot.visual_links);
  parameters.read("fixed_joints", robot.fixed_joints);
  parameters.read("primitives_file", robot.primitives_file);
  parameters.read("apply_mesh_up_axis", robot.apply_mesh_up_axis);
  parameters.read("fit_primitives_max", robot.fit.primitives_max);
  parameters.read("fit_split_gain", robot.fit.split_gain);
  robot.validate();
  return robot;
}

AssemblerSettings readAssemblerSettings(Parameters& parameters) {
  AssemblerSettings settings;
  parameters.read("fixed_frame", settings.fixed_frame);
  parameters.read("self_filter", settings.self_filter);
  read(parameters, kSelfFilterKeys, settings.body.filtered);
  parameters.read("scan_beams_max", settings.assembler.scan_beams_max);
  parameters.read("scan_unknown_fraction_max", settings.assembler.scan_unknown_fraction_max);
  parameters.read("mixed_pixel_separation_m", settings.assembler.mixed_pixel.separation_m);
  parameters.read("self_filter_range_tolerance_m", settings.assembler.body.range_tolerance_m);
  parameters.read("self_filter_grazing_m", settings.assembler.body.grazing_m);
  parameters.read("self_filter_shadow_depth_m", settings.assembler.body.shadow_depth_m);
  parameters.read("self_filter_attached_padding_m", settings.body.attached_padding_m);
  parameters.read("self_filter_lateness_s", settings.body.lateness_s);
  parameters.read("body_sample_s", settings.body.sample_s);
  read(parameters, settings.body.joints);
  parameters.read("transform_gap_max_s", settings.transform_gap_max_s);
  parameters.read("transform_sample_s", settings.transform_sample_s);
  parameters.read("transform_wait_max_s", settings.transform_wait_max_s);
  parameters.read("future_max_s", settings.future_max_s);
  parameters.read("marker_rate_hz", settings.marker_rate_hz);
  requireFrame(settings.fixed_frame);
  settings.assembler.validate();
  settings.body.validate();
  requireInRange("transform_gap_max_s", settings.transform_gap_max_s, 0.001, 10.0);
  requireInRange("transform_sample_s", settings.transform_sample_s, 1e-4, 1.0);
  requireInRange("transform_wait_max_s", settings.transform_wait_max_s, 0.001, 10.0);
  requireInRange("future_max_s", settings.future_max_s, 0.0, 10.0);
  requireInRange("marker_rate_hz", settings.marker_rate_hz, 0.1, 100.0);
  return settings;
}

MapperSettings readMapperSettings(Parameters& parameters) {
  MapperSettings settings;
  Mapper::Config& mapper = settings.mapper;
  read(parameters, mapper.map.grid);
  parameters.read("thickness_m", mapper.map.thickness_m);
  parameters.read("window_scans", mapper.window_scans);
  parameters.read("window_s", mapper.window_s);
  parameters.read("window_tilt_periods", mapper.window_tilt_periods);
  parameters.read("window_scans_max", mapper.map.scans_max);
  parameters.read("window_returns_max", mapper.map.returns_max);
  parameters.read("intervals_max", mapper.map.intervals_max);
  parameters.read("tilt_hysteresis_rad", mapper.tilt.hysteresis_rad);
  parameters.read("scan_gap_max_s", mapper.scan_gap_max_s);
  parameters.read("time_jump_back_s", mapper.time_jump_back_s);
  parameters.read("look_resolution_rad", mapper.looks.resolution_rad);
  parameters.read("look_spread_rad", mapper.looks.spread_rad);
  parameters.read("look_pass_gap_s", mapper.looks.pass_gap_s);
  parameters.read("hold_s", mapper.hold_s);
  parameters.read("hold_look_angle_rad", mapper.hold_look_angle_rad);
  parameters.read("hold_outline_rad", mapper.hold_outline_rad);
  parameters.read("hold_look_short_m", mapper.hold_look_short_m);
  parameters.read("held_max", mapper.held_max);
  parameters.read("marker_rate_hz", settings.marker_rate_hz);
  parameters.read("static_windows", settings.static_windows);
  mapper.validate();
  requireInRange("marker_rate_hz", settings.marker_rate_hz, 0.1, 100.0);
  requireInRange("static_windows", settings.static_windows, 1, 1000);
  return settings;
}

CheckerSettings readCheckerSettings(Parameters& parameters) {
  CheckerSettings settings;
  Checker::Config& checker = settings.checker;
  parameters.read("fixed_frame", settings.fixed_frame);
  read(parameters, checker);
  checker.inputs.fixed_frame = settings.fixed_frame;
  parameters.read("attach_forget_padding_m", settings.attach_forget_padding_m);
  parameters.read("attach_forget_s", settings.attach_forget_s);
  parameters.read("publish_rate_hz", settings.publish_rate_hz);
  parameters.read("permission_valid_periods", settings.permission_valid_periods);
  parameters.read("check_time_max_periods", settings.check_time_max_periods);
  parameters.read("tuning_padding_min_m", settings.tuning_padding_min_m);
  parameters.read("tuning_stop_time_min_s", settings.tuning_stop_time_min_s);
  parameters.read("marker_rate_hz", settings.marker_rate_hz);
  requireFrame(settings.fixed_frame);
  checker.validate();
  requireInRange("attach_forget_padding_m", settings.attach_forget_padding_m, 0.0, 1.0);
  requireInRange("attach_forget_s", settings.attach_forget_s, 0.0, 10.0);
  requireInRange("publish_rate_hz", settings.publish_rate_hz, 1.0, 1000.0);
  requireInRange("permission_valid_periods", settings.permission_valid_periods, 1.0, 3.0);
  requireInRange("check_time_max_periods", settings.check_time_max_periods, 1e-6, 100.0);
  requireInRange("tuning_padding_min_m", settings.tuning_padding_min_m, 0.0, 1.0);
  requireInRange("tuning_stop_time_min_s", settings.tuning_stop_time_min_s, 0.0, 10.0);
  requireInRange("marker_rate_hz", settings.marker_rate_hz, 0.1, 100.0);
  return settings;
}

Monitor::Config MonitorSettings::monitorConfig() const {
  Monitor::Config config;
  config.assembler = assembler.assembler;
  config.self_filter = assembler.self_filter;
  config.body = assembler.body;
  config.mapper = mapper.mapper;
  config.checker = checker.checker;
  return config;
}

MonitorSettings readMonitorSettings(const std::string& path) {
  const YAML::Node file = loadFile(path);
  Parameters top(file, path);
  for (const std::string& key : top.unknownKeys()) {
    if (key == kRobotSection || key == "tilt_scan_assembler" || key == "tccm_mapper" ||
        key == "collision_checker" || key == "topics") {
      continue;
    }
    throw ConfigError(path + ": '" + key +
                      "' names no nodelet, nor is it monitored_robot or topics");
  }
  MonitorSettings settings;
  Parameters robot = section(file, kRobotSection);
  settings.robot = readRobotSettings(robot);
  refuseUnknown(robot);
  Parameters assembler = section(file, "tilt_scan_assembler");
  settings.assembler = readAssemblerSettings(assembler);
  refuseUnknown(assembler);
  Parameters mapper = section(file, "tccm_mapper");
  settings.mapper = readMapperSettings(mapper);
  refuseUnknown(mapper);
  Parameters checker = section(file, "collision_checker");
  settings.checker = readCheckerSettings(checker);
  refuseUnknown(checker);
  Parameters topics = section(file, "topics");
  topics.read("scan", settings.scan_topic);
  topics.read("joint_states", settings.joint_states_topic);
  refuseUnknown(topics);
  if (settings.assembler.fixed_frame != settings.checker.fixed_frame) {
    throw ConfigError("fixed_frame: tilt_scan_assembler and collision_checker name different ones");
  }
  return settings;
}

}  // namespace tccm

#include "nodelets/speed_slider.h"

#include <std_msgs/Float32.h>
#include <std_msgs/Float64.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/line_of.h"
#include "ros/handles.h"

namespace tccm {
namespace {

constexpr char kUrService[] = "ur_msgs/SetSpeedSliderFraction";
constexpr double kChange = 0.01;  // of the fraction; a rise by less is not worth a message
constexpr double kLeast = 0.01;   // that robots take

/// The request and response of ur_msgs/SetSpeedSliderFraction: the package is not needed.
struct SliderRequest {
  double speed_slider_fraction = 0.0;
};
struct SliderResponse {
  std::uint8_t success = 0;
};

}  // namespace
}  // namespace tccm

namespace ros::serialization {

template <>
struct Serializer<tccm::SliderRequest> {
  template <typename Stream, typename Request>
  static void allInOne(Stream& stream, Request request) {
    stream.next(request.speed_slider_fraction);
  }
  ROS_DECLARE_ALLINONE_SERIALIZER
};

template <>
struct Serializer<tccm::SliderResponse> {
  template <typename Stream, typename Response>
  static void allInOne(Stream& stream, Response response) {
    stream.next(response.success);
  }
  ROS_DECLARE_ALLINONE_SERIALIZER
};

}  // namespace ros::serialization

namespace tccm {

bool SpeedSlider::knows(const std::string& type) {
  return type == "std_msgs/Float64" || type == "std_msgs/Float32" || type == kUrService;
}

SpeedSlider::SpeedSlider(const ros::NodeHandle& node, const std::string& name,
                         const std::string& type)
    : type_(type) {
  if (type == "std_msgs/Float64") {
    topic_ = advertise<std_msgs::Float64>(node, name, 10, true);
  } else if (type == "std_msgs/Float32") {
    topic_ = advertise<std_msgs::Float32>(node, name, 10, true);
  } else {
    service_.emplace(node, name, "172aeb6c49379a44cf68480fa5bfad3c");
    thread_ = std::thread([this] { run(); });
  }
}

SpeedSlider::~SpeedSlider() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    is_over_ = true;
  }
  news_.notify_one();
  service_->end();
  thread_.join();
}

void SpeedSlider::set(double fraction) {
  const std::lock_guard<std::mutex> lock(mutex_);
  fraction = std::max(fraction, kLeast);
  const bool is_near = set_ && fraction >= *set_ && fraction < *set_ + kChange;
  if (is_near && defect_.empty() && fraction < 1.0) return;
  set_ = fraction;
  defect_.clear();
  if (type_ == kUrService) {
    wanted_ = fraction;
    news_.notify_one();
  } else if (type_ == "std_msgs/Float64") {
    std_msgs::Float64 message;
    message.data = fraction;
    topic_.publish(message);
  } else {
    std_msgs::Float32 message;
    message.data = static_cast<float>(fraction);
    topic_.publish(message);
  }
}

bool SpeedSlider::isSet() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return !wanted_ && !is_calling_ && defect_.empty();
}

std::string SpeedSlider::defect() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!defect_.empty() || type_ == kUrService) return defect_;
  if (topic_.getNumSubscribers() > 0) return {};
  return "nobody listens to the speed slider's topic " + topic_.getTopic();
}

void SpeedSlider::forget() {
  const std::lock_guard<std::mutex> lock(mutex_);
  wanted_.reset();
  set_.reset();
  defect_.clear();
}

void SpeedSlider::run() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (true) {
    news_.wait(lock, [this] { return is_over_ || wanted_; });
    if (is_over_) return;
    const double fraction = *std::exchange(wanted_, std::nullopt);
    is_calling_ = true;
    lock.unlock();
    std::string defect = call(fraction);
    lock.lock();
    is_calling_ = false;
    defect_ = std::move(defect);
  }
}

std::string SpeedSlider::call(double fraction) {
  SliderRequest request{fraction};
  SliderResponse response;
  if (!service_->call(request, response)) {
    return "the speed slider's service " + service_->name() + " does not answer";
  }
  if (response.success != 0) return {};
  return lineOf("the speed slider's service %.150s refuses %.3g", service_->name().c_str(),
                fraction);
}

}  // namespace tccm

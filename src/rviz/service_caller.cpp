#include "rviz/service_caller.h"

#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace tccm {
namespace {

constexpr int kPeriod_ms = 50;

}  // namespace

struct ServiceCaller::Answer {
  std::mutex mutex;
  std::optional<std::string> text;
};

ServiceCaller::ServiceCaller(QObject* parent) : QObject(parent) {
  timer_.setInterval(kPeriod_ms);
  connect(&timer_, &QTimer::timeout, this, &ServiceCaller::look);
}

void ServiceCaller::start(const std::string& what, std::function<std::string()> call) {
  what_ = QString::fromStdString(what);
  looks_ = 0;
  answer_ = std::make_shared<Answer>();
  // Nobody can end a call that is not answered: the thread is left alone with what it needs.
  std::thread([answer = answer_, call = std::move(call)] {
    std::string text = call();
    const std::lock_guard<std::mutex> lock(answer->mutex);
    answer->text = std::move(text);
  }).detach();
  Q_EMIT told(what_ + " ...");
  timer_.start();
}

void ServiceCaller::look() {
  std::optional<std::string> text;
  {
    const std::lock_guard<std::mutex> lock(answer_->mutex);
    text = answer_->text;
  }
  ++looks_;
  if (text) {
    timer_.stop();
    Q_EMIT told(what_ + ": " + QString::fromStdString(*text));
  } else if (looks_ % (1000 / kPeriod_ms) == 0) {
    Q_EMIT told(QString("%1: no answer for %2 s").arg(what_).arg(looks_ * kPeriod_ms / 1000));
  }
}

}  // namespace tccm

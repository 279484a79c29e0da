#pragma once

#include <ros/ros.h>
#include <rviz/panel.h>

#include <QTimer>
#include <map>
#include <string>
#include <vector>

#include "ros/advice.h"
#include "rviz/status_text.h"

class QGridLayout;
class QLabel;
class QLineEdit;
class QPushButton;
class QVBoxLayout;

namespace tccm {

class ServiceCaller;

/// What the monitor says, why, and what can be done about it. What is older than a second is not
/// shown. All callbacks come in rviz's own thread.
class MonitorPanel : public rviz::Panel {
  Q_OBJECT

 public:
  explicit MonitorPanel(QWidget* parent = nullptr);

  void onInitialize() override;
  void load(const rviz::Config& config) override;
  void save(rviz::Config config) const override;

 private:
  void changeNamespace();
  void refresh();
  void reset();
  void clearMap();
  void attach();
  void detach();
  void addLevel(QVBoxLayout& layout);
  void addReasons(QVBoxLayout& layout);
  void addButtons(QVBoxLayout& layout);
  void addNamespace(QVBoxLayout& layout);
  void take(const tccm_monitor::MonitorStatus& status);
  void subscribe();
  void showStatus();
  void showSilence();
  void showRows(const std::vector<TextRow>& rows);
  void showSensors();
  void showButtons(bool heard);
  /// A name in the monitor's namespace. @throws ros::Exception where that is none; the buttons are
  /// off then.
  [[nodiscard]] std::string absolute(const std::string& name) const;

  QLabel *level_, *reason_, *detail_, *advice_, *sensors_, *answer_;
  QGridLayout* grid_;
  std::map<std::string, QLabel*> values_;
  QPushButton *reset_, *clear_, *attach_, *detach_;
  QLineEdit* name_space_;
  ServiceCaller* services_;
  QTimer timer_;

  Advice about_;
  ros::Subscriber status_subscriber_, diagnostics_subscriber_;
  tccm_monitor::MonitorStatus status_;
  ros::WallTime heard_;    ///< the status; 0: none
  ros::WallTime refused_;  ///< when `reset` would have been, last; 0: never
  LastStop last_stop_;
  bool changed_ = false;
  SensorHealth health_;
};

}  // namespace tccm

#include "rviz/monitor_panel.h"

#include <tccm_monitor/DetachObject.h>

#include <QGridLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QLineEdit>
#include <QMenu>
#include <QPushButton>
#include <QVBoxLayout>
#include <algorithm>
#include <array>
#include <pluginlib/class_list_macros.hpp>

#include "rviz/attach_dialog.h"
#include "rviz/service_caller.h"
#include "rviz/service_calls.h"

namespace tccm {
namespace {

using tccm_monitor::MonitorStatus;

constexpr int kPeriod_ms = 100;
constexpr double kSilence_s = 1.0;
constexpr double kRefusal_s = 0.5;  // a contact comes and goes
const char* const kSilentColor = "rgb(128, 128, 128)";
const char* const kLastStop = "Last stop";
const char* const kReset =
    "background-color: rgb(255, 140, 0); color: black; font-weight: bold; border: 1px solid black; "
    "border-radius: 3px; padding: 4px;";

const char* colorOf(std::uint8_t level) {
  constexpr std::array<const char*, 4> kColors{"rgb(46, 160, 67)", "rgb(240, 200, 0)",
                                               "rgb(215, 40, 40)", "rgb(150, 0, 150)"};
  return level < kColors.size() ? kColors[level] : kSilentColor;
}

const char* colorOfHealth(std::uint8_t level) {
  constexpr std::array<const char*, 4> kColors{"#2ea043", "#d08700", "#d72828", "#808080"};
  return level < kColors.size() ? kColors[level] : kColors.back();
}

QString toQt(const std::string& text) { return QString::fromStdString(text); }

QLabel* newLabel() {
  auto* label = new QLabel;
  label->setWordWrap(true);
  label->setTextFormat(Qt::PlainText);
  label->setTextInteractionFlags(Qt::TextSelectableByMouse);
  return label;
}

}  // namespace

MonitorPanel::MonitorPanel(QWidget* parent)
    : rviz::Panel(parent), services_(new ServiceCaller(this)) {
  auto* layout = new QVBoxLayout(this);
  addLevel(*layout);
  addButtons(*layout);
  addReasons(*layout);
  grid_ = new QGridLayout;
  grid_->setColumnStretch(1, 1);
  layout->addLayout(grid_);
  sensors_ = newLabel();
  sensors_->setTextFormat(Qt::RichText);
  layout->addWidget(sensors_);
  addNamespace(*layout);
  layout->addStretch(1);
  showRows({{kLastStop, ""}});
  showRows(rowsOf(MonitorStatus()));
  connect(&timer_, &QTimer::timeout, this, &MonitorPanel::refresh);
  connect(services_, &ServiceCaller::told, answer_, &QLabel::setText);
}

void MonitorPanel::addLevel(QVBoxLayout& layout) {
  level_ = newLabel();
  level_->setAlignment(Qt::AlignCenter);
  level_->setFixedHeight(56);
  layout.addWidget(level_);
}

void MonitorPanel::addReasons(QVBoxLayout& layout) {
  reason_ = newLabel();
  reason_->setStyleSheet("font-weight: bold;");
  detail_ = newLabel();
  advice_ = newLabel();
  advice_->setStyleSheet("color: rgb(90, 90, 90); font-style: italic;");
  for (QLabel* label : {reason_, detail_, advice_}) layout.addWidget(label);
}

/// Above all whose height changes: they stay where they are.
void MonitorPanel::addButtons(QVBoxLayout& layout) {
  reset_ = new QPushButton("Reset");
  clear_ = new QPushButton("Clear map");
  attach_ = new QPushButton("Attach...");
  detach_ = new QPushButton("Detach...");
  auto* row = new QGridLayout;
  row->addWidget(reset_, 0, 0);
  row->addWidget(clear_, 0, 1);
  row->addWidget(attach_, 1, 0);
  row->addWidget(detach_, 1, 1);
  layout.addLayout(row);
  answer_ = newLabel();
  layout.addWidget(answer_);
  connect(reset_, &QPushButton::clicked, this, &MonitorPanel::reset);
  connect(clear_, &QPushButton::clicked, this, &MonitorPanel::clearMap);
  connect(attach_, &QPushButton::clicked, this, &MonitorPanel::attach);
  connect(detach_, &QPushButton::clicked, this, &MonitorPanel::detach);
}

void MonitorPanel::addNamespace(QVBoxLayout& layout) {
  auto* name_row = new QHBoxLayout;
  name_space_ = new QLineEdit;
  name_space_->setPlaceholderText("of this rviz");
  name_row->addWidget(new QLabel("Namespace"));
  name_row->addWidget(name_space_);
  layout.addLayout(name_row);
  connect(name_space_, &QLineEdit::editingFinished, this, &MonitorPanel::changeNamespace);
}

void MonitorPanel::onInitialize() {
  about_ = Advice::ofThePage();
  subscribe();
  refresh();
  timer_.start(kPeriod_ms);
}

void MonitorPanel::load(const rviz::Config& config) {
  rviz::Panel::load(config);
  QString name_space;
  if (config.mapGetString("Namespace", &name_space)) name_space_->setText(name_space);
  subscribe();
}

void MonitorPanel::save(rviz::Config config) const {
  rviz::Panel::save(config);
  config.mapSetValue("Namespace", name_space_->text());
}

std::string MonitorPanel::absolute(const std::string& name) const {
  return ros::names::resolve(ros::names::append(name_space_->text().toStdString(), name));
}

void MonitorPanel::changeNamespace() {
  subscribe();
  Q_EMIT configChanged();
}

void MonitorPanel::subscribe() {
  heard_ = refused_ = ros::WallTime();
  last_stop_ = LastStop();
  status_subscriber_ = ros::Subscriber();
  bool named = false;
  try {
    const std::string topic = absolute("monitor_status");
    named = true;
    health_ = SensorHealth(ros::names::parentNamespace(topic));
    ros::NodeHandle node;
    // Each one, however slowly this draws: a stop may be over after a few.
    status_subscriber_ = node.subscribe<MonitorStatus>(
        topic, 200, [this](const MonitorStatus::ConstPtr& status) { take(*status); });
    diagnostics_subscriber_ = node.subscribe<diagnostic_msgs::DiagnosticArray>(
        "/diagnostics", 100, [this](const diagnostic_msgs::DiagnosticArray::ConstPtr& message) {
          health_.take(*message, ros::WallTime::now().toSec());
        });
  } catch (const ros::Exception& error) {
    answer_->setText(error.what());
  }
  for (QPushButton* button : {reset_, clear_, attach_}) button->setEnabled(named);
}

void MonitorPanel::take(const MonitorStatus& status) {
  status_ = status;
  heard_ = ros::WallTime::now();
  changed_ = true;
  last_stop_.take(status, heard_.toSec());
  if (refusesReset(status)) refused_ = heard_;
}

void MonitorPanel::refresh() {
  const bool heard = !heard_.isZero() && (ros::WallTime::now() - heard_).toSec() <= kSilence_s;
  if (!heard) {
    showSilence();
  } else if (changed_) {
    showStatus();
  }
  changed_ = false;
  showRows({{kLastStop, last_stop_.text(ros::WallTime::now().toSec())}});
  showButtons(heard);
  showSensors();
}

void MonitorPanel::showStatus() {
  const std::string level = levelName(status_.level);
  level_->setText(toQt(level));
  level_->setStyleSheet(QString("background-color: %1; color: white; font-size: 30px; "
                                "font-weight: bold;")
                            .arg(colorOf(status_.level)));
  reason_->setText(toQt(reasonOf(status_)));
  detail_->setText(toQt(detailOf(status_)));
  const std::string advice = about_.about(status_.reason, level);
  advice_->setText(advice.empty() || advice == "nothing" ? "" : "To do: " + toQt(advice));
  showRows(rowsOf(status_));
}

void MonitorPanel::showSilence() {
  level_->setText("SILENT");
  level_->setStyleSheet(
      QString("background-color: %1; color: white; font-size: 30px; font-weight: bold;")
          .arg(kSilentColor));
  const double silence = (ros::WallTime::now() - heard_).toSec();
  reason_->setText(heard_.isZero() ? QString("nothing heard")
                                   : QString("silent for %1 s").arg(silence, 0, 'f', 1));
  const std::string topic = status_subscriber_.getTopic();
  detail_->setText(topic.empty() ? "the namespace is not valid" : toQt("on " + topic));
  advice_->setText("");
  for (const auto& [name, label] : values_) label->setText("?");  // the last stop's comes after
}

void MonitorPanel::showRows(const std::vector<TextRow>& rows) {
  for (const TextRow& row : rows) {
    QLabel*& value = values_[row.name];
    if (value == nullptr) {
      value = newLabel();
      const int line = grid_->rowCount();
      grid_->addWidget(new QLabel(toQt(row.name)), line, 0, Qt::AlignTop);
      grid_->addWidget(value, line, 1);
    }
    value->setText(toQt(row.text));
  }
}

void MonitorPanel::showSensors() {
  QString text;
  for (const SensorHealth::Line& line : health_.lines(ros::WallTime::now().toSec())) {
    text += QString("<div><span style='color: %1'>&#9679;</span> %2: %3</div>")
                .arg(colorOfHealth(line.level), toQt(line.name).toHtmlEscaped(),
                     toQt(line.text).toHtmlEscaped());
  }
  if (text.isEmpty()) text = "no diagnostics of sensors";
  if (text != sensors_->text()) sensors_->setText(text);
}

void MonitorPanel::showButtons(bool heard) {
  // What it takes to go on is to be seen, once it is of use.
  const bool is_due =
      !status_.latched.empty() && (ros::WallTime::now() - refused_).toSec() > kRefusal_s;
  const QString style = heard && is_due ? kReset : "";
  if (reset_->styleSheet() != style) reset_->setStyleSheet(style);
  detach_->setEnabled(heard && !status_.attached_objects.empty());
}

void MonitorPanel::reset() {
  services_->start("Reset",
                   [name = absolute("reset")] { return callService<std_srvs::Trigger>(name, {}); });
}

void MonitorPanel::clearMap() {
  const std::string name_space = ros::names::parentNamespace(absolute("clear_map"));
  services_->start("Clear map", [name_space] { return clearMaps(name_space); });
}

void MonitorPanel::attach() {
  std::vector<std::string> links;
  for (const tccm_monitor::LinkStatus& link : status_.links) links.push_back(link.link);
  std::sort(links.begin(), links.end());
  links.erase(std::unique(links.begin(), links.end()), links.end());
  AttachDialog dialog(links, this);
  if (dialog.exec() != QDialog::Accepted) return;
  services_->start("Attach", [name = absolute("attach_object"), request = dialog.request()] {
    return callService<tccm_monitor::AttachObject>(name, request);
  });
}

void MonitorPanel::detach() {
  QMenu menu;
  for (const std::string& name : status_.attached_objects) menu.addAction(toQt(name));
  menu.addSeparator();
  const QAction* all = menu.addAction("all");
  const QAction* chosen = menu.exec(detach_->mapToGlobal(QPoint(0, detach_->height())));
  if (chosen == nullptr) return;
  tccm_monitor::DetachObject::Request request;
  if (chosen != all) request.name = chosen->text().toStdString();
  services_->start("Detach", [name = absolute("detach_object"), request] {
    return callService<tccm_monitor::DetachObject>(name, request);
  });
}

}  // namespace tccm

PLUGINLIB_EXPORT_CLASS(tccm::MonitorPanel, rviz::Panel)

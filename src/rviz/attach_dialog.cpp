#include "rviz/attach_dialog.h"

#include <QComboBox>
#include <QDialogButtonBox>
#include <QDoubleSpinBox>
#include <QFormLayout>
#include <QLineEdit>
#include <cmath>

#include "tccm_monitor/pose.h"

namespace tccm {

AttachDialog::AttachDialog(const std::vector<std::string>& links, QWidget* parent)
    : QDialog(parent), name_(new QLineEdit("object")), link_(new QComboBox), shape_(new QComboBox) {
  setWindowTitle("Attach an object");
  auto* form = new QFormLayout(this);
  link_->setEditable(true);
  for (const std::string& link : links) link_->addItem(QString::fromStdString(link));
  shape_->addItems({"box", "cylinder", "capsule", "sphere"});
  form->addRow("Name", name_);
  form->addRow("Link", link_);
  form->addRow("Shape", shape_);
  const std::array<const char*, 3> axes{"x", "y", "z"}, turns{"Roll", "Pitch", "Yaw"};
  for (std::size_t i = 0; i < 3; ++i) {
    size_[i] = addNumber(*form, QString("Size along %1").arg(axes[i]), " m", 0.001, 10.0, 0.1);
  }
  radius_ = addNumber(*form, "Radius", " m", 0.001, 10.0, 0.05);
  length_ = addNumber(*form, "Length along z", " m", 0.001, 10.0, 0.1);
  for (std::size_t i = 0; i < 3; ++i) {
    position_[i] = addNumber(*form, QString("Middle, %1").arg(axes[i]), " m", -10.0, 10.0, 0.0);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    angles_[i] = addNumber(*form, turns[i], " deg", -360.0, 360.0, 0.0);
  }
  auto* buttons = new QDialogButtonBox(QDialogButtonBox::Ok | QDialogButtonBox::Cancel);
  form->addRow(buttons);
  connect(buttons, &QDialogButtonBox::accepted, this, &QDialog::accept);
  connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::reject);
  connect(shape_, &QComboBox::currentTextChanged, this, &AttachDialog::changeShape);
  changeShape();
}

QDoubleSpinBox* AttachDialog::addNumber(QFormLayout& form, const QString& name, const QString& unit,
                                        double low, double high, double value) {
  auto* box = new QDoubleSpinBox;
  box->setDecimals(3);
  box->setRange(low, high);
  box->setSingleStep(0.01);
  box->setSuffix(unit);
  box->setValue(value);
  form.addRow(name, box);
  return box;
}

void AttachDialog::changeShape() {
  const QString shape = shape_->currentText();
  for (QDoubleSpinBox* size : size_) size->setEnabled(shape == "box");
  radius_->setEnabled(shape != "box");
  length_->setEnabled(shape == "cylinder" || shape == "capsule");
}

tccm_monitor::AttachObject::Request AttachDialog::request() const {
  tccm_monitor::AttachObject::Request request;
  request.name = name_->text().toStdString();
  request.link = link_->currentText().toStdString();
  tccm_monitor::Primitive& primitive = request.primitive;
  primitive.shape = shape_->currentText().toStdString();
  primitive.size.x = size_[0]->isEnabled() ? size_[0]->value() : 0.0;
  primitive.size.y = size_[1]->isEnabled() ? size_[1]->value() : 0.0;
  primitive.size.z = size_[2]->isEnabled() ? size_[2]->value() : 0.0;
  primitive.radius = radius_->isEnabled() ? radius_->value() : 0.0;
  primitive.length = length_->isEnabled() ? length_->value() : 0.0;
  primitive.pose.position.x = position_[0]->value();
  primitive.pose.position.y = position_[1]->value();
  primitive.pose.position.z = position_[2]->value();
  const auto turn = [this](std::size_t i, const Vector3& axis) {
    return Eigen::AngleAxisd(angles_[i]->value() * M_PI / 180.0, axis);
  };
  const Eigen::Quaterniond q(turn(2, Vector3::UnitZ()) * turn(1, Vector3::UnitY()) *
                             turn(0, Vector3::UnitX()));
  primitive.pose.orientation.x = q.x();
  primitive.pose.orientation.y = q.y();
  primitive.pose.orientation.z = q.z();
  primitive.pose.orientation.w = q.w();
  return request;
}

}  // namespace tccm

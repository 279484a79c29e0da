#pragma once

#include <tccm_monitor/AttachObject.h>

#include <QDialog>
#include <array>
#include <string>
#include <vector>

class QComboBox;
class QDoubleSpinBox;
class QFormLayout;
class QLineEdit;

namespace tccm {

/// Asks for an object that the robot holds from now on.
class AttachDialog : public QDialog {
  Q_OBJECT

 public:
  /// @param links to choose from; others may be typed.
  AttachDialog(const std::vector<std::string>& links, QWidget* parent);

  [[nodiscard]] tccm_monitor::AttachObject::Request request() const;

 private:
  void changeShape();
  QDoubleSpinBox* addNumber(QFormLayout& form, const QString& name, const QString& unit, double low,
                            double high, double value);

  QLineEdit* name_;
  QComboBox *link_, *shape_;
  std::array<QDoubleSpinBox*, 3> size_;      ///< along x, y and z [m]
  QDoubleSpinBox *radius_, *length_;         ///< [m]
  std::array<QDoubleSpinBox*, 3> position_;  ///< [m]
  std::array<QDoubleSpinBox*, 3> angles_;    ///< roll, pitch and yaw [degrees]
};

}  // namespace tccm

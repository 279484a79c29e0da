#pragma once

#include <QObject>
#include <QString>
#include <QTimer>
#include <functional>
#include <memory>
#include <string>

namespace tccm {

/// Calls services in threads of their own: one that does not answer stops no window. Knows of one
/// call at a time; of one that was begun before its answer came the answer is not told.
class ServiceCaller : public QObject {
  Q_OBJECT

 public:
  explicit ServiceCaller(QObject* parent);

  /// @param what to call it. @param call is made in another thread, and returns what to tell.
  void start(const std::string& what, std::function<std::string()> call);

 Q_SIGNALS:
  void told(const QString& text);

 private:
  void look();
  struct Answer;

  QTimer timer_;
  QString what_;
  int looks_ = 0;
  std::shared_ptr<Answer> answer_;
};

}  // namespace tccm

#pragma once

#include <urdf_model/model.h>

#include <string>
#include <vector>

#include "fit/fit_cache.h"
#include "fit/primitives_file.h"
#include "robot/robot_model.h"

namespace tccm {

/// Reads the primitives of links: from the file of primitives, from the URDF's primitives, or by a
/// fit to its meshes.
class LinkGeometryReader {
 public:
  /// Keeps references. @throws ConfigError where the file of primitives cannot be taken.
  LinkGeometryReader(const RobotModel::Config& config, const RobotResources& resources,
                     const LinkSelector& selector);

  [[nodiscard]] bool hasShape(const urdf::Link& link) const;
  /// Links that the file of primitives names, and others that were to be read.
  [[nodiscard]] const LinkPrimitives& file() const { return file_; }

  struct Result {
    std::vector<LinkElement> elements;
    std::vector<LinkShape> shapes;
  };
  /// @param links in the model's order. @throws ConfigError naming link and element.
  [[nodiscard]] Result read(const std::vector<urdf::LinkConstSharedPtr>& links,
                            const std::vector<std::size_t>& indices);

  [[nodiscard]] std::string cacheDefect() const { return cache_.saveProblem(); }

 private:
  /// A geometry and where it is.
  struct Placed {
    urdf::GeometrySharedPtr geometry;
    urdf::Pose origin;
  };
  [[nodiscard]] std::vector<Placed> geometriesOf(const urdf::Link& link) const;
  void readFromFile(const urdf::Link& link, std::size_t index);
  void readElement(const urdf::Link& link, std::size_t index, const Placed& placed);
  void fitMesh(const urdf::Mesh& mesh, const std::string& owner, LinkElement& element);
  [[nodiscard]] std::string contentOf(const std::string& uri) const;

  const RobotModel::Config& config_;
  const RobotResources& resources_;
  const LinkSelector& selector_;
  LinkPrimitives file_;
  FitCache cache_;
  std::size_t meshes_done_ = 0;
  std::size_t meshes_ = 0;
  Result result_;
};

}  // namespace tccm
